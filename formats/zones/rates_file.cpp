#include "rayfield/formats/rates_file.h"

#include <cpl_vsi.h>
#include <fmt/format.h>
#include <ogrsf_frmts.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <map>

#include "formats/gis/gdal_session.h"
#include "formats/io/guard.h"
#include "formats/zones/rate_unit.h"
#include "rayfield/core/text_file.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kWhat = "cannot read rates";
constexpr const char* kForm = "give one line `zone,rate` for each zone below a header line with these names";

tl::unexpected<Error> refused(const std::string& path, const std::string& why) {
  return fail(ErrorCode::bad_input, kWhat, path, why, kForm);
}

/// A number that is the whole of a text.
template <class Number>
bool parse(std::string text, Number& number) {
  text.erase(0, text.find_first_not_of(" \t"));
  text.erase(text.find_last_not_of(" \t\r") + 1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

Result<std::map<int, double>> read_lines(OGRLayer& layer, const RateUnit& unit, const std::string& path) {
  const int zone_field = layer.GetLayerDefn()->GetFieldIndex("zone");
  const int rate_field = layer.GetLayerDefn()->GetFieldIndex("rate");
  if (zone_field < 0 || rate_field < 0) return refused(path, "it has no columns zone and rate");
  std::map<int, double> rates;
  int line = 1;
  for (auto& feature : layer) {
    ++line;
    int zone = 0;
    double rate = 0;
    const std::string text = feature->GetFieldAsString(rate_field);
    if (!parse(feature->GetFieldAsString(zone_field), zone))
      return refused(path, fmt::format("line {}: '{}' is no zone", line, feature->GetFieldAsString(zone_field)));
    if (!parse(text, rate) || !std::isfinite(rate))
      return refused(path, fmt::format("line {}: '{}' is no rate", line, text));
    if (rate < 0 || rate * unit.steps > std::numeric_limits<std::int32_t>::max())
      return refused(path, fmt::format("line {}: {} {} is out of range", line, text, unit.name));
    if (!rates.emplace(zone, rate).second) return refused(path, fmt::format("line {}: zone {} again", line, zone));
  }
  return rates;
}

/// Rates in the order of the zones, whose numbers run from 1.
Result<std::vector<double>> by_zone(const std::map<int, double>& rates, std::size_t zones, const std::string& path) {
  for (const auto& [number, rate] : rates)
    if (number < 1 || number > static_cast<int>(zones))
      return refused(path, fmt::format("there is no zone {}: the block has zones 1 to {}", number, zones));
  std::vector<double> all;
  for (int number = 1; number <= static_cast<int>(zones); ++number) {
    const auto found = rates.find(number);
    if (found == rates.end()) return refused(path, fmt::format("zone {} has no rate", number));
    all.push_back(found->second);
  }
  return all;
}

Result<std::map<int, double>> read_table(const std::string& path, const RateUnit& unit) {
  RAYFIELD_ASSIGN(std::string text, read_text_file(path, kWhat));
  const GdalSession gdal;
  const std::string copy = fmt::format("/vsimem/rayfield-rates-{}.csv", static_cast<const void*>(text.data()));
  VSILFILE* file = VSIFileFromMemBuffer(copy.c_str(), reinterpret_cast<GByte*>(text.data()), text.size(), FALSE);
  if (file != nullptr) VSIFCloseL(file);
  const char* allowed[] = {"CSV", nullptr};
  DatasetPtr dataset(GDALDataset::Open(copy.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, allowed));
  auto rates = dataset == nullptr || dataset->GetLayerCount() != 1
                   ? Result<std::map<int, double>>(refused(path, "it is not a readable CSV file"))
                   : read_lines(*dataset->GetLayer(0), unit, path);
  dataset.reset();
  VSIUnlink(copy.c_str());
  return rates;
}

}  // namespace

std::vector<std::string> rate_units() {
  std::vector<std::string> names;
  for (const RateUnit& unit : known_rate_units()) names.emplace_back(unit.name);
  return names;
}

Result<Prescription> read_rates(const std::string& path, const std::string& unit, const std::string& product,
                                const std::vector<ManagementZone>& zones) {
  return guarded(kWhat, path, [&]() -> Result<Prescription> {
    const RateUnit* known = find_rate_unit(unit);
    if (known == nullptr)
      return fail(ErrorCode::usage, kWhat, unit, "unknown unit of rates",
                  fmt::format("give one of {}", fmt::join(rate_units(), ", ")));
    if (product.empty()) return fail(ErrorCode::usage, kWhat, path, "no product given", "name it with --product");
    RAYFIELD_ASSIGN(const auto rates, read_table(path, *known));
    Prescription prescription{product, std::string(known->name), {}};
    RAYFIELD_ASSIGN(prescription.rates, by_zone(rates, zones.size(), path));
    return prescription;
  });
}

}  // namespace rayfield::formats
