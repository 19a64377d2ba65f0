#include "mcap/foxglove_schemas.hpp"

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

namespace rfmvo::mcap {
namespace {

using Json = nlohmann::ordered_json;

Json of_type(const char* type) { return {{"type", type}}; }
Json number() { return of_type("number"); }
Json integer() { return of_type("integer"); }
Json text() { return of_type("string"); }
Json flag() { return of_type("boolean"); }
Json array_of(const Json& item) { return {{"type", "array"}, {"items", item}}; }

Json object(const char* title, std::initializer_list<std::pair<const char*, Json>> fields) {
  Json schema{{"type", "object"}, {"title", title}, {"properties", Json::object()}};
  for (const auto& [name, field] : fields) schema["properties"][name] = field;
  return schema;
}

Json seconds(const char* title) {
  return object(title, {{"sec", integer()}, {"nsec", {{"type", "integer"}, {"minimum", 0}, {"maximum", 999'999'999}}}});
}
Json time() { return seconds("time"); }
Json vector3(const char* title) { return object(title, {{"x", number()}, {"y", number()}, {"z", number()}}); }
Json quaternion() {
  return object("foxglove.Quaternion", {{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}
Json pose() {
  return object("foxglove.Pose", {{"position", vector3("foxglove.Vector3")}, {"orientation", quaternion()}});
}
Json color() { return object("foxglove.Color", {{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}}); }

Json sphere() {
  return object("foxglove.SpherePrimitive",
                {{"pose", pose()}, {"size", vector3("foxglove.Vector3")}, {"color", color()}});
}
Json line() {
  return object("foxglove.LinePrimitive", {{"type", integer()},
                                           {"pose", pose()},
                                           {"thickness", number()},
                                           {"scale_invariant", flag()},
                                           {"points", array_of(vector3("foxglove.Point3"))},
                                           {"color", color()},
                                           {"colors", array_of(color())},
                                           {"indices", array_of(integer())}});
}
Json label() {
  return object("foxglove.TextPrimitive", {{"pose", pose()},
                                           {"billboard", flag()},
                                           {"font_size", number()},
                                           {"scale_invariant", flag()},
                                           {"color", color()},
                                           {"text", text()}});
}

}  // namespace

std::string frame_transform_schema() {
  return object("foxglove.FrameTransform", {{"timestamp", time()},
                                            {"parent_frame_id", text()},
                                            {"child_frame_id", text()},
                                            {"translation", vector3("foxglove.Vector3")},
                                            {"rotation", quaternion()}})
      .dump();
}

std::string scene_update_schema() {
  const Json deletion =
      object("foxglove.SceneEntityDeletion", {{"timestamp", time()}, {"type", integer()}, {"id", text()}});
  const Json pair = object("foxglove.KeyValuePair", {{"key", text()}, {"value", text()}});
  const Json nothing = array_of(of_type("object"));
  const Json entity = object("foxglove.SceneEntity", {{"timestamp", time()},
                                                      {"frame_id", text()},
                                                      {"id", text()},
                                                      {"lifetime", seconds("duration")},
                                                      {"frame_locked", flag()},
                                                      {"metadata", array_of(pair)},
                                                      {"arrows", nothing},
                                                      {"cubes", nothing},
                                                      {"spheres", array_of(sphere())},
                                                      {"cylinders", nothing},
                                                      {"lines", array_of(line())},
                                                      {"triangles", nothing},
                                                      {"texts", array_of(label())},
                                                      {"models", nothing}});
  return object("foxglove.SceneUpdate", {{"deletions", array_of(deletion)}, {"entities", array_of(entity)}}).dump();
}

std::string compressed_image_schema() {
  return object("foxglove.CompressedImage", {{"timestamp", time()},
                                             {"frame_id", text()},
                                             {"data", {{"type", "string"}, {"contentEncoding", "base64"}}},
                                             {"format", text()}})
      .dump();
}

std::string camera_calibration_schema() {
  return object("foxglove.CameraCalibration", {{"timestamp", time()},
                                               {"frame_id", text()},
                                               {"width", integer()},
                                               {"height", integer()},
                                               {"distortion_model", text()},
                                               {"D", array_of(number())},
                                               {"K", array_of(number())},
                                               {"R", array_of(number())},
                                               {"P", array_of(number())}})
      .dump();
}

std::string log_schema() {
  return object("foxglove.Log", {{"timestamp", time()},
                                 {"level", integer()},
                                 {"message", text()},
                                 {"name", text()},
                                 {"file", text()},
                                 {"line", integer()}})
      .dump();
}

}  // namespace rfmvo::mcap
