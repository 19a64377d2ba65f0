#include "reproduce/results.hpp"

namespace rfmvo::reproduce {

const char* key_of(Method method) {
  constexpr ByMethod<const char*> kKeys{"paper_search", "paper",   "repaired_search", "repaired",
                                        "joint",        "tagoram", "mobitagbot"};
  return kKeys[index_of(method)];
}

std::vector<std::optional<double>> tag_errors_m(const Run& run, Method method) {
  const auto distances = [](const std::vector<std::optional<BaselineTag>>& tags) {
    std::vector<std::optional<double>> errors;
    for (const auto& tag : tags) errors.push_back(tag ? std::optional(tag->error_m) : std::nullopt);
    return errors;
  };
  switch (method) {
    case Method::kPaperSearch:
      return run.paper.search_error_m;
    case Method::kPaper:
      return run.paper.error_m;
    case Method::kRepairedSearch:
      return run.repaired.search_error_m;
    case Method::kRepaired:
      return run.repaired.error_m;
    case Method::kJoint:
      return run.joint_error_m;
    case Method::kTagoram:
      return distances(run.tagoram);
    case Method::kMobiTagbot:
      return distances(run.mobitagbot);
  }
  return {};
}

const std::vector<ScaleError>& scale_errors(const Run& run, Method method) {
  static const std::vector<ScaleError> kNone;
  switch (method) {
    case Method::kPaperSearch:
      return run.paper.search_scale;
    case Method::kPaper:
      return run.paper.scale;
    case Method::kRepairedSearch:
      return run.repaired.search_scale;
    case Method::kRepaired:
      return run.repaired.scale;
    case Method::kJoint:
      return run.joint_scale;
    default:
      return kNone;
  }
}

}  // namespace rfmvo::reproduce
