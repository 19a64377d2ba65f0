// What the paper reports: RF-MVO, sections IV and VII. Its other values are in its plots only.
#pragma once

namespace rfmvo::reproduce::published {

inline constexpr double kTagErrorSearch_m = 0.0820;  // VII.C, 30 runs, 8 tags: without joint optimization
inline constexpr double kTagError_m = 0.0623;        // with
inline constexpr double kTagoram_m = 0.0541, kMobiTagbot_m = 0.0364;
inline constexpr double kScaleSearch = 0.0501, kScaleSearchSigma = 0.0188;  // VII.D, Eq. (31): mean, deviation
inline constexpr double kScale = 0.0158, kScaleSigma = 0.0124;
inline constexpr double kSearch_s = 0.52, kFineSearch_s = 14.24;  // VII.F: gamma by 0.1 and by 0.05
inline constexpr double kOptimization_s = 0.016;                  // IV: four updates on average

}  // namespace rfmvo::reproduce::published
