#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/console/option_settings.h"
#include "cli/console/output_paths.h"
#include "cli/products/exchange_products.h"
#include "cli/products/zone_block.h"

namespace rayfield::cli {
namespace {

using nlohmann::ordered_json;

struct ZoneArguments {
  std::string store, folder, date, of = "leaf_area_per_m";
  std::optional<int> classes;
  std::string rates, rate_unit, product;
  std::vector<std::string> profiles, settings;
};

// JSON has no NaN and no infinity.
ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(); }

ordered_json map_json(const ZoneMap& map) {
  ordered_json json = {{"block", map.block},
                       {"scan_id", map.scan.scan_id},
                       {"date", map.scan.scan_date},
                       {"snapshot", map.snapshot},
                       {"value", map.value},
                       {"unit", map.unit},
                       {"area_m2", map.area_m2},
                       {"explained", number(map.explained)},
                       {"zones", ordered_json::array()}};
  for (const ManagementZone& zone : map.zones)
    json["zones"].push_back({{"zone", zone.zone},
                             {"parts", zone.parts.size()},
                             {"area_m2", zone.area_m2},
                             {"class_low", number(zone.low)},
                             {"class_high", number(zone.high)},
                             {"mean", number(zone.mean)},
                             {"min", number(zone.min)},
                             {"max", number(zone.max)},
                             {"measured", zone.measured}});
  return json;
}

std::string map_text(const ZoneMap& map) {
  std::string text =
      fmt::format("{}, {}: {} of {}, {:.3f} ha; {:.0f} % of the variance lies between zones\n", map.block,
                  map.scan.scan_id, map.zones.size() == 1 ? "1 zone" : fmt::format("{} zones", map.zones.size()),
                  map.meaning, map.area_m2 / 1e4, 100 * map.explained);
  for (const ManagementZone& zone : map.zones)
    text +=
        fmt::format("  zone {}  {:.3f} ha in {}  mean {:.2f} {}  ({:.2f} … {:.2f})\n", zone.zone, zone.area_m2 / 1e4,
                    zone.parts.size() == 1 ? "1 part" : fmt::format("{} parts", zone.parts.size()), zone.mean, map.unit,
                    zone.min, zone.max);
  return text;
}

Result<std::optional<RatesRequest>> rates_of(const ZoneArguments& arguments) {
  const bool any = !arguments.rates.empty() || !arguments.rate_unit.empty() || !arguments.product.empty();
  if (!any) return std::nullopt;
  if (arguments.rates.empty() || arguments.rate_unit.empty() || arguments.product.empty())
    return fail(ErrorCode::usage, "cannot make a prescription map", "--rates, --rate-unit, --product",
                "one of them is missing", "give all three, or none for zones alone");
  return RatesRequest{arguments.rates, arguments.rate_unit, arguments.product};
}

Result<Outcome> run_zones(const ZoneArguments& arguments, const Context& context) {
  RAYFIELD_CHECK(check_outside_stores(arguments.folder, "cannot make zones", "give another -o"));
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(arguments.store));
  ZoneRequest request;
  request.date = arguments.date, request.of = arguments.of;
  RAYFIELD_CHECK(apply_settings(arguments.settings, request.options));
  if (arguments.classes) request.options.classes = *arguments.classes;
  RAYFIELD_ASSIGN(request.rates, rates_of(arguments));
  request.profiles = {arguments.profiles.begin(), arguments.profiles.end()};
  if (!context.options.dry_run) request.folder = arguments.folder;
  RAYFIELD_ASSIGN(const ZoneReport report, zone_block(store, request, context.progress));
  Outcome outcome;
  outcome.data = map_json(report.map);
  outcome.text = map_text(report.map);
  outcome.data["dry_run"] = context.options.dry_run;
  outcome.data["files"] = ordered_json::array();
  for (const auto& path : report.files) {
    outcome.data["files"].push_back(path.string());
    outcome.text += path.string() + "\n";
  }
  return outcome;
}

}  // namespace

void add_zones_command(Commands& commands) {
  const auto arguments = std::make_shared<ZoneArguments>();
  CLI::App* command =
      commands.add("zones", "Draw management zones of a block, and a prescription map",
                   "rayfield zones myblock -o maps --classes 3\n"
                   "  rayfield zones myblock -o maps --rates rates.csv --rate-unit l/ha --product \"Copper\"",
                   [arguments](Context& context) { return run_zones(*arguments, context); });
  command->add_option("STORE", arguments->store, "Folder of the store")->required();
  command->add_option("-o,--output", arguments->folder, "Folder to write to")->required();
  command->add_option("--date", arguments->date, "Date or scan (default: the newest)")->type_name("DATE");
  command->add_option("--of", arguments->of, "What zones are made of (default: leaf_area_per_m)")
      ->transform(CLI::IsMember({"leaf_area_per_m", "plan_density"}, CLI::ignore_case));
  command->add_option("--classes", arguments->classes, "Number of classes, 2 … 5 (default: 3)")
      ->type_name("N")
      ->check(valid_for<density::ZoneOptions>("classes"));
  command->add_option("--rates", arguments->rates, "CSV file with columns zone and rate: writes a prescription map")
      ->type_name("FILE.csv");
  command
      ->add_option("--rate-unit", arguments->rate_unit,
                   "l/ha, ml/m2, m3/ha, gal/ac, kg/ha, g/m2, t/ha, lb/ac, 1/ha or 1/m2")
      ->type_name("UNIT");
  command->add_option("--product", arguments->product, "What is applied")->type_name("NAME");
  command->add_option("--profile", arguments->profiles, "Zipped shapefiles after the rules of farm systems")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->transform(CLI::IsMember(profile_names(), CLI::ignore_case));
  add_settings_option(*command, arguments->settings);
}

}  // namespace rayfield::cli
