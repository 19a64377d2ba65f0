// What an EPC says, where it follows GS1: the EPC tag URI of the 96-bit schemes of trade, logistics, places and
// assets. GS1 EPC Tag Data Standard, section 14 (binary) and 12 (URI).
#pragma once

#include <optional>
#include <string>

#include "rf/epc.hpp"

namespace rfmvo {

// "urn:epc:tag:sgtin-96:3.0614141.812345.6789" for SGTIN-96, SSCC-96, SGLN-96, GRAI-96, GIAI-96. Nothing for
// other headers and for codes that the standard does not allow: those are shown as hex, never guessed.
[[nodiscard]] std::optional<std::string> epc_tag_uri(const Epc& epc);

}  // namespace rfmvo
