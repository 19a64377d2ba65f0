#include "simulate/environment.hpp"

namespace rfmvo::simulate {
namespace {

constexpr double kTiledTexels_per_m = 320.0;

using Eigen::Vector3d;

void add_face(Environment& environment, const Vector3d& corner, const Vector3d& right, const Vector3d& down,
              double width_m, double height_m, const TexturePointer& texture, bool stretch, float brightness) {
  Surface s{corner, right, down, width_m, height_m, texture, {kTiledTexels_per_m, kTiledTexels_per_m}, brightness};
  const double side = static_cast<double>(1 << texture->bits());
  if (stretch) s.texels_per_m = {side / width_m, side / height_m};
  environment.surfaces.push_back(s);
}

}  // namespace

void add_box(Environment& e, const Vector3d& low, const Vector3d& high, const BoxTextures& t) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const Vector3d size = high - low;
  // Light falls from above and in front: the faces differ in brightness, so that edges show.
  add_face(e, {low.x(), low.y(), high.z()}, x, -z, size.x(), size.z(), t.front, t.stretch, 1.0F);
  add_face(e, {low.x(), high.y(), high.z()}, -y, -z, size.y(), size.z(), t.side, t.stretch, 0.7F);
  add_face(e, {high.x(), low.y(), high.z()}, y, -z, size.y(), size.z(), t.side, t.stretch, 0.8F);
  add_face(e, {low.x(), high.y(), high.z()}, x, -y, size.x(), size.y(), t.top, t.stretch, 1.15F);
  add_face(e, low, x, y, size.x(), size.y(), t.top, t.stretch, 0.45F);
}

Surface moved(Surface surface, const Rigid3& T) {
  surface.corner = T * surface.corner;
  surface.right = T.R * surface.right;
  surface.down = T.R * surface.down;
  return surface;
}

void add_poster(Environment& e, const Vector3d& corner, double width_m, double height_m,
                const TexturePointer& texture) {
  add_face(e, corner, Vector3d::UnitX(), -Vector3d::UnitZ(), width_m, height_m, texture, true, 1.0F);
}

}  // namespace rfmvo::simulate
