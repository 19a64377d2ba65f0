#include "simulate/aisle_surroundings.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulate/random.hpp"

namespace rfmvo::simulate {
namespace {

using Eigen::Vector3d;

constexpr double kFrom_m = -2.6, kTo_m = 9.4;  // of the racks along x
constexpr double kRackFront_m = 1.45, kRackDepth_m = 0.9;
constexpr double kFarRack_m = -1.5;  // the other side of the aisle
constexpr double kBay_m = 2.0;
constexpr double kUpright_m = 0.09, kRackHeight_m = 2.9;
constexpr std::array<double, 4> kShelves_m{0.12, 0.72, 1.32, 1.92};
constexpr double kBeam_m = 0.09;  // height of a shelf's beam
constexpr double kCeiling_m = 4.2;

// Amplitude reflection coefficients, averaged over polarisation and angle. Concrete (relative permittivity
// 5..6, ITU-R P.2040) gives 0.3..0.45; sheet steel is 1, but shelves are perforated and half covered, a
// rack's back is a wire mesh, the far rack is as much hole as metal, the roof is ribbed and far.
constexpr double kFloorReflection = -0.3, kCeilingReflection = -0.3;
constexpr double kShelfReflection = -0.15, kMeshReflection = -0.1, kFarRackReflection = -0.3;
// Physical optics of a strip 9 cm wide, cut into pieces of 16 cm (half a wavelength): 4 pi A^2 / lambda^2.
constexpr double kUprightPiece_m = 0.16, kUprightCrossSection_m2 = 0.025;
constexpr int kRandomScatterers = 100;  // goods and fittings
constexpr double kScattererMin_m2 = 0.002, kScattererMax_m2 = 0.02;

void add_surfaces(Environment& e, Random& look) {
  const TexturePointer floor = concrete_texture(look), back = clutter_texture(look);
  const double length_m = kTo_m - kFrom_m;
  e.surfaces.push_back({{kFrom_m, kRackFront_m + kRackDepth_m, 0.0},
                        Vector3d::UnitX(),
                        -Vector3d::UnitY(),
                        length_m,
                        3.5,
                        floor,
                        {420, 420},
                        0.9F});
  e.surfaces.push_back({{kFrom_m - 4, kRackFront_m + kRackDepth_m + 0.9, 4.0},
                        Vector3d::UnitX(),
                        -Vector3d::UnitZ(),
                        length_m + 8,
                        4.0,
                        back,
                        {190, 190},
                        0.8F});
}

void add_rack(Environment& e, Random& look) {
  const TexturePointer steel = steel_texture(look), beam = steel_texture(look), board = clutter_texture(look);
  for (double x_m = kFrom_m; x_m <= kTo_m + 0.01; x_m += kBay_m) {
    for (const double y_m : {kRackFront_m, kRackFront_m + kRackDepth_m - kUpright_m}) {
      add_box(e, {x_m, y_m, 0.0}, {x_m + kUpright_m, y_m + kUpright_m, kRackHeight_m}, {steel, steel, steel, false});
    }
    for (double z_m = 0.5 * kUprightPiece_m; z_m < kRackHeight_m; z_m += kUprightPiece_m) {
      e.scatterers.push_back({{x_m + 0.5 * kUpright_m, kRackFront_m, z_m}, kUprightCrossSection_m2});
    }
  }
  for (const double z_m : kShelves_m) {
    add_box(e, {kFrom_m, kRackFront_m + 0.02, z_m - kBeam_m}, {kTo_m, kRackFront_m + 0.07, z_m},
            {beam, beam, board, false});
    add_box(e, {kFrom_m, kRackFront_m + 0.07, z_m - 0.03}, {kTo_m, kRackFront_m + kRackDepth_m, z_m - 0.005},
            {beam, beam, board, false});
  }
}

std::vector<Carton> add_cartons(Environment& e, Random& look, Random& random) {
  std::vector<Carton> cartons;
  for (const double shelf_m : kShelves_m) {
    double x_m = kFrom_m + random.uniform(0.1, 0.3);
    while (x_m < kTo_m - 0.7) {
      const double width_m = random.uniform(0.28, 0.6), depth_m = random.uniform(0.3, 0.5),
                   height_m = random.uniform(0.22, 0.45);
      const double front_m = kRackFront_m + random.uniform(0.03, 0.28);
      // Cartons do not stand in the uprights.
      const double bay_x_m = x_m - kFrom_m - kBay_m * std::floor((x_m - kFrom_m) / kBay_m);
      if (bay_x_m < kUpright_m + 0.03) x_m += kUpright_m + 0.03 - bay_x_m;
      if (bay_x_m + width_m > kBay_m) x_m += kBay_m - bay_x_m + kUpright_m + 0.03;
      const Carton carton{{x_m, front_m, shelf_m}, {x_m + width_m, front_m + depth_m, shelf_m + height_m}};
      add_box(e, carton.low, carton.high, {cardboard_texture(look), cardboard_texture(look), cardboard_texture(look)});
      cartons.push_back(carton);
      x_m += width_m + random.uniform(0.02, 0.25);
    }
  }
  std::stable_sort(cartons.begin(), cartons.end(),
                   [](const Carton& a, const Carton& b) { return a.low.x() < b.low.x(); });
  return cartons;
}

void add_reflectors(Environment& e, Random& random) {
  const double mid_x_m = 0.5 * (kFrom_m + kTo_m), half_m = 0.5 * (kTo_m - kFrom_m);
  const double rack_mid_m = kRackFront_m + 0.5 * kRackDepth_m;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  e.reflectors.push_back({{mid_x_m, 0, 0}, z, x, half_m, 20.0, kFloorReflection});
  e.reflectors.push_back({{mid_x_m, 0, kCeiling_m}, z, x, half_m, 20.0, kCeilingReflection});
  for (const double shelf_m : kShelves_m) {
    e.reflectors.push_back({{mid_x_m, rack_mid_m, shelf_m}, z, x, half_m, 0.5 * kRackDepth_m, kShelfReflection});
  }
  e.reflectors.push_back({{mid_x_m, kRackFront_m + kRackDepth_m, 0.5 * kRackHeight_m},
                          y,
                          x,
                          half_m,
                          0.5 * kRackHeight_m,
                          kMeshReflection});
  e.reflectors.push_back(
      {{mid_x_m, kFarRack_m, 0.5 * kRackHeight_m}, y, x, half_m, 0.5 * kRackHeight_m, kFarRackReflection});
  for (int n = 0; n < kRandomScatterers; ++n) {
    const double x_m = random.uniform(kFrom_m, kTo_m), z_m = random.uniform(0.1, 2.3);
    const double y_m = kRackFront_m + random.uniform(0.1, kRackDepth_m);
    e.scatterers.push_back({{x_m, y_m, z_m}, random.uniform(kScattererMin_m2, kScattererMax_m2)});
  }
}

}  // namespace

std::vector<Carton> build_aisle(Environment& environment, std::uint64_t seed) {
  Random look(seed, "textures");
  Random random(seed, "cartons");
  Random echo(seed, "scatterers");
  add_surfaces(environment, look);
  add_rack(environment, look);
  std::vector<Carton> cartons = add_cartons(environment, look, random);
  add_reflectors(environment, echo);
  return cartons;
}

}  // namespace rfmvo::simulate
