// Extensions of Impinj (vendor 25882) and Zebra (vendor 161, formerly Motorola) that carry phase: typed views of
// Custom. Numbers:
// three open codecs and captures of an R420 and an FX9600 (firmware 3.32.37) agree.
#pragma once

#include <optional>

#include "edges/llrp/decoder.hpp"
#include "edges/llrp/encoder.hpp"
#include "edges/llrp/schema.hpp"

namespace rfmvo::llrp {

inline constexpr std::uint32_t kImpinj = 25882, kZebra = 161;

// CUSTOM_MESSAGE: without it an Impinj reader reports no extension on this connection.
inline constexpr std::uint8_t kImpinjEnableExtensions = 21, kImpinjEnableExtensionsResponse = 22;

struct Extension {
  std::uint32_t vendor;
  std::uint32_t subtype;
};

struct ImpinjInventorySearchMode {
  static constexpr Extension kExtension{kImpinj, 23};
  static constexpr std::uint16_t kDualTarget = 2;
  std::uint16_t mode = kDualTarget;
  static void fields(auto& v, auto& s) { v.value("InventorySearchMode", s.mode); }
};

struct ImpinjEnableSerializedTID {
  static constexpr Extension kExtension{kImpinj, 51};
  std::uint16_t mode = 0;
  static void fields(auto& v, auto& s) { v.value("SerializedTIDMode", s.mode); }
};

struct ImpinjEnableRFPhaseAngle {
  static constexpr Extension kExtension{kImpinj, 52};
  std::uint16_t mode = 1;
  static void fields(auto& v, auto& s) { v.value("RFPhaseAngleMode", s.mode); }
};

struct ImpinjEnablePeakRSSI {
  static constexpr Extension kExtension{kImpinj, 53};
  std::uint16_t mode = 1;
  static void fields(auto& v, auto& s) { v.value("PeakRSSIMode", s.mode); }
};

struct ImpinjEnableRFDopplerFrequency {
  static constexpr Extension kExtension{kImpinj, 67};
  std::uint16_t mode = 1;
  static void fields(auto& v, auto& s) { v.value("RFDopplerFrequencyMode", s.mode); }
};

// Child of ROReportSpec only; of its parameters, those above.
struct ImpinjTagReportContentSelector {
  static constexpr Extension kExtension{kImpinj, 50};
  std::vector<Custom> parts;
  static void fields(auto& v, auto& s) { v.child(s.parts); }
};

struct ImpinjRFPhaseAngle {
  static constexpr Extension kExtension{kImpinj, 56};
  static constexpr int kTurnBits = 12;
  std::uint16_t phase = 0;  // 0..4095 = one turn
  static void fields(auto& v, auto& s) { v.value("PhaseAngle", s.phase); }
};

struct ImpinjPeakRSSI {
  static constexpr Extension kExtension{kImpinj, 57};
  std::int16_t rssi_cdbm = 0;
  static void fields(auto& v, auto& s) { v.value("RSSI", s.rssi_cdbm); }
};

struct ImpinjRFDopplerFrequency {
  static constexpr Extension kExtension{kImpinj, 68};
  std::int16_t doppler_hz_q4 = 0;  // 1/16 Hz
  static void fields(auto& v, auto& s) { v.value("DopplerFrequency", s.doppler_hz_q4); }
};

// Child of ROReportSpec. Guides disagree about the number of reserved bits; the capture has 32 bits in all.
struct MotoTagReportContentSelector {
  static constexpr Extension kExtension{kZebra, 708};
  static constexpr std::uint32_t kPhase = 1U << 28;
  std::uint32_t enables = kPhase;
  static void fields(auto& v, auto& s) { v.value("Enables", s.enables); }
};

struct MotoTagPhase {
  static constexpr Extension kExtension{kZebra, 709};
  std::int16_t phase = 0;  // 65536 = one turn
  static void fields(auto& v, auto& s) { v.value("Phase", s.phase); }
};

// Child of AntennaConfiguration's C1G2InventoryCommand; its query configuration c000 asks for both targets.
struct MotoAntennaConfig {
  static constexpr Extension kExtension{kZebra, 703};
  std::vector<Custom> parts;
  static void fields(auto& v, auto& s) { v.child(s.parts); }
};

struct MotoAntennaQueryConfig {
  static constexpr Extension kExtension{kZebra, 710};
  std::uint16_t query = 0xC000;
  static void fields(auto& v, auto& s) { v.value("Query", s.query); }
};

template <class T>
[[nodiscard]] Custom pack(const T& x) {
  Encoder encoder;
  T::fields(encoder, x);
  return {T::kExtension.vendor, T::kExtension.subtype, std::move(encoder).take()};
}

// The first extension of this kind, if it is there and long enough; what follows its fields is ignored, for
// readers that say more than their guides.
template <class T>
[[nodiscard]] std::optional<T> unpack(const std::vector<Custom>& customs) {
  for (const Custom& custom : customs) {
    if (custom.vendor_identifier != T::kExtension.vendor || custom.parameter_subtype != T::kExtension.subtype) continue;
    Decoding decoding;
    decoding.path.push_back("Custom");
    T x;
    if constexpr (requires { x.parts; }) {
      decode_into(x, custom.data, decoding);
    } else {
      FieldReader fields(custom.data, decoding);
      T::fields(fields, x);
    }
    if (decoding.error.empty()) return x;
  }
  return std::nullopt;
}

}  // namespace rfmvo::llrp
