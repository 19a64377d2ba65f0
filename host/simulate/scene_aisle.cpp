#include "simulate/scene.hpp"
namespace rfmvo::simulate {
Scene make_aisle_scene(const Options& options) { Options o = options; o.scene = "S3"; return make_stacked_scene(o); }
Scene make_wall_scene(const Options& options) { Options o = options; o.scene = "S3"; return make_stacked_scene(o); }
}
