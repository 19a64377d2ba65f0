#include "simulate/inventory.hpp"
namespace rfmvo::simulate {
RadioLink make_physical_link(const Scene& scene) { return make_statistical_link(scene, 1); }
std::vector<Singulation> gen2_inventory(const Scene& s, const RadioLink& l, std::uint64_t n) { return statistical_inventory(s, l, n); }
}
