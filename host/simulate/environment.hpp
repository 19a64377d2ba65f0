// What surrounds the cart: surfaces that the camera sees, and reflectors that the radio waves see.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "geometry/rigid.hpp"
#include "simulate/texture.hpp"

namespace rfmvo::simulate {

// A textured rectangle, visible from the side where `right` is right and `down` is down.
struct Surface {
  Eigen::Vector3d corner;  // upper left
  Eigen::Vector3d right;   // unit vector
  Eigen::Vector3d down;    // unit vector
  double width_m = 1.0;
  double height_m = 1.0;
  TexturePointer texture;
  Eigen::Vector2d texels_per_m{100.0, 100.0};
  float brightness = 1.0F;
};

// A flat mirror for radio waves: a rectangle with a real reflection coefficient (negative: the phase
// turns by pi, as at metal and at dense dielectrics).
struct Reflector {
  Eigen::Vector3d centre;
  Eigen::Vector3d normal;  // unit vector; both sides reflect
  Eigen::Vector3d axis;    // unit vector in the plane, along half_length
  double half_length_m = 1.0;
  double half_width_m = 1.0;
  double coefficient = -0.5;
};

// Something small that scatters in all directions.
struct Scatterer {
  Eigen::Vector3d p;
  double cross_section_m2 = 0.01;
};

// People and vehicles: surfaces in a frame of their own, which moves.
struct Mover {
  std::vector<Surface> surfaces;
  std::function<Rigid3(double)> T_S_M;  // at a time (s)
};

struct Environment {
  std::vector<Surface> surfaces;
  std::vector<Mover> movers;
  std::vector<Reflector> reflectors;
  std::vector<Scatterer> scatterers;
};

// The six faces of a box; `stretch`: each texture covers its face once, else it repeats every metre or so.
struct BoxTextures {
  TexturePointer front, side, top;
  bool stretch = true;
};
void add_box(Environment& environment, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
             const BoxTextures& textures);

// A rectangle in the plane y = const that looks towards -y, upper left corner (x, y, z).
void add_poster(Environment& environment, const Eigen::Vector3d& corner, double width_m, double height_m,
                const TexturePointer& texture);

[[nodiscard]] Surface moved(Surface surface, const Rigid3& T);

}  // namespace rfmvo::simulate
