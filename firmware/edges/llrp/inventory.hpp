// How tags are inventoried on one antenna: power, channel, Gen2 mode, session. LLRP 1.0.1 sections 12.2.6, 15.2.1.
// Names are the standard's; one `fields` per parameter serves decoding and encoding (schema.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "edges/llrp/schema.hpp"

namespace rfmvo::llrp {

struct RFReceiver {
  static constexpr Name kName{223, "RFReceiver"};
  std::uint16_t receiver_sensitivity = 0;
  static void fields(auto& v, auto& s) { v.value("ReceiverSensitivity", s.receiver_sensitivity); }
};

struct RFTransmitter {
  static constexpr Name kName{224, "RFTransmitter"};
  std::uint16_t hop_table_id = 0;
  std::uint16_t channel_index = 0;
  std::uint16_t transmit_power = 0;
  static void fields(auto& v, auto& s) {
    v.value("HopTableID", s.hop_table_id);
    v.value("ChannelIndex", s.channel_index);
    v.value("TransmitPower", s.transmit_power);
  }
};

struct C1G2TagInventoryMask {
  static constexpr Name kName{332, "C1G2TagInventoryMask"};
  std::uint8_t mb = 0;
  std::uint16_t pointer = 0;
  BitString tag_mask;
  static void fields(auto& v, auto& s) {
    v.bits("MB", s.mb, 2);
    v.reserved(6);
    v.value("Pointer", s.pointer);
    v.value("TagMask", s.tag_mask);
  }
};

struct C1G2TagInventoryStateAwareFilterAction {
  static constexpr Name kName{333, "C1G2TagInventoryStateAwareFilterAction"};
  std::uint8_t target = 0;
  std::uint8_t action = 0;
  static void fields(auto& v, auto& s) {
    v.value("Target", s.target);
    v.value("Action", s.action);
  }
};

struct C1G2TagInventoryStateUnawareFilterAction {
  static constexpr Name kName{334, "C1G2TagInventoryStateUnawareFilterAction"};
  std::uint8_t action = 0;
  static void fields(auto& v, auto& s) { v.value("Action", s.action); }
};

struct C1G2Filter {
  static constexpr Name kName{331, "C1G2Filter"};
  std::uint8_t t = 0;
  C1G2TagInventoryMask c1g2_tag_inventory_mask;
  std::optional<C1G2TagInventoryStateAwareFilterAction> c1g2_tag_inventory_state_aware_filter_action;
  std::optional<C1G2TagInventoryStateUnawareFilterAction> c1g2_tag_inventory_state_unaware_filter_action;
  static void fields(auto& v, auto& s) {
    v.bits("T", s.t, 2);
    v.reserved(6);
    v.child(s.c1g2_tag_inventory_mask);
    v.child(s.c1g2_tag_inventory_state_aware_filter_action);
    v.child(s.c1g2_tag_inventory_state_unaware_filter_action);
  }
};

struct C1G2RFControl {
  static constexpr Name kName{335, "C1G2RFControl"};
  std::uint16_t mode_index = 0;
  std::uint16_t tari = 0;
  static void fields(auto& v, auto& s) {
    v.value("ModeIndex", s.mode_index);
    v.value("Tari", s.tari);
  }
};

struct C1G2TagInventoryStateAwareSingulationAction {
  static constexpr Name kName{337, "C1G2TagInventoryStateAwareSingulationAction"};
  bool i = false;
  bool s = false;
  static void fields(auto& v, auto& s) {
    v.bits("I", s.i, 1);
    v.bits("S", s.s, 1);
    v.reserved(6);
  }
};

struct C1G2SingulationControl {
  static constexpr Name kName{336, "C1G2SingulationControl"};
  std::uint8_t session = 0;
  std::uint16_t tag_population = 0;
  std::uint32_t tag_transit_time = 0;
  std::optional<C1G2TagInventoryStateAwareSingulationAction> c1g2_tag_inventory_state_aware_singulation_action;
  static void fields(auto& v, auto& s) {
    v.bits("Session", s.session, 2);
    v.reserved(6);
    v.value("TagPopulation", s.tag_population);
    v.value("TagTransitTime", s.tag_transit_time);
    v.child(s.c1g2_tag_inventory_state_aware_singulation_action);
  }
};

struct C1G2InventoryCommand {
  static constexpr Name kName{330, "C1G2InventoryCommand"};
  bool tag_inventory_state_aware = false;
  std::vector<C1G2Filter> c1g2_filters;
  std::optional<C1G2RFControl> c1g2_rf_control;
  std::optional<C1G2SingulationControl> c1g2_singulation_control;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.bits("TagInventoryStateAware", s.tag_inventory_state_aware, 1);
    v.reserved(7);
    v.child(s.c1g2_filters);
    v.child(s.c1g2_rf_control);
    v.child(s.c1g2_singulation_control);
    v.child(s.customs);
  }
};

struct AntennaConfiguration {
  static constexpr Name kName{222, "AntennaConfiguration"};
  std::uint16_t antenna_id = 0;
  std::optional<RFReceiver> rf_receiver;
  std::optional<RFTransmitter> rf_transmitter;
  std::vector<C1G2InventoryCommand> c1g2_inventory_commands;
  static void fields(auto& v, auto& s) {
    v.value("AntennaID", s.antenna_id);
    v.child(s.rf_receiver);
    v.child(s.rf_transmitter);
    v.child(s.c1g2_inventory_commands);
  }
};

struct InventoryParameterSpec {
  static constexpr Name kName{186, "InventoryParameterSpec"};
  std::uint16_t inventory_parameter_spec_id = 0;
  std::uint8_t protocol_id = 0;
  std::vector<AntennaConfiguration> antenna_configurations;
  std::vector<Custom> customs;
  static void fields(auto& v, auto& s) {
    v.value("InventoryParameterSpecID", s.inventory_parameter_spec_id);
    v.value("ProtocolID", s.protocol_id);
    v.child(s.antenna_configurations);
    v.child(s.customs);
  }
};

}  // namespace rfmvo::llrp
