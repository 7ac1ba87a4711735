#include "formats/zones/rate_unit.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace rayfield::formats {
namespace {

constexpr double kSquareMetresPerHectare = 1e4, kSquareMetresPerAcre = 4046.8564224;
constexpr double kCubicMillimetresPerLitre = 1e6, kLitresPerGallon = 3.785411784, kMilligramsPerPound = 453592.37;
/// Steps per mm³/m², mg/m² and 1/m².
constexpr double kVolume = 100, kMass = 1, kCount = 1000;

constexpr std::array<RateUnit, 10> kUnits = {{
    {"l/ha", "0001", kVolume* kCubicMillimetresPerLitre / kSquareMetresPerHectare, 1},
    {"ml/m2", "0001", kVolume * 1e3, 3},
    {"m3/ha", "0001", kVolume * 1e9 / kSquareMetresPerHectare, 3},
    {"gal/ac", "0001", kVolume* kLitresPerGallon* kCubicMillimetresPerLitre / kSquareMetresPerAcre, 2},
    {"kg/ha", "0006", kMass * 1e6 / kSquareMetresPerHectare, 1},
    {"g/m2", "0006", kMass * 1e3, 2},
    {"t/ha", "0006", kMass * 1e9 / kSquareMetresPerHectare, 3},
    {"lb/ac", "0006", kMass* kMilligramsPerPound / kSquareMetresPerAcre, 1},
    {"1/ha", "000B", kCount / kSquareMetresPerHectare, 0},
    {"1/m2", "000B", kCount, 2},
}};

}  // namespace

std::span<const RateUnit> known_rate_units() { return kUnits; }

const RateUnit* find_rate_unit(std::string_view name) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  const auto found = std::find_if(kUnits.begin(), kUnits.end(), [&](const RateUnit& unit) {
    return std::equal(unit.name.begin(), unit.name.end(), name.begin(), name.end(), same);
  });
  return found == kUnits.end() ? nullptr : &*found;
}

}  // namespace rayfield::formats
