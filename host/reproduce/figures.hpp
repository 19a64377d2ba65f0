// Fig. 7 to 13 of the paper, from the results.
#pragma once

#include <vector>

#include "reproduce/curves.hpp"

namespace rfmvo::reproduce {

// Always all of them, in the paper's order; those of which nothing was measured have no curve.
[[nodiscard]] std::vector<FigureData> figures_of(const Results& results);

// Fig. 8 and 9 of the real frames.
[[nodiscard]] std::vector<FigureData> real_frame_figures(const Study& study);

}  // namespace rfmvo::reproduce
