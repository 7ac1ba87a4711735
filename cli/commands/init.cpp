#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/console/output_paths.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/density/registry.h"
#include "rayfield/formats/reference_file.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

// Where the survey lies, the CRS has to be true to scale.
Result<void> check_place(const SurveyedBlock& survey, const std::string& crs, Progress& progress) {
  std::optional<Eigen::Vector2d> place;
  if (!survey.posts.empty()) place = survey.posts.front().position;
  for (const SurveyedRow& row : survey.rows)
    if (!place && !row.line.empty()) place = row.line.front();
  if (!place) return {};
  RAYFIELD_ASSIGN(const auto warning, check_map_place(crs, {place->x(), place->y(), 0}));
  if (warning) progress.warn(*warning);
  return {};
}

// A store without scans that has the same settings may be what an earlier run has left that was stopped, or that could
// not make it durable: the same command goes on. Any other store is refused.
Result<void> check_free(const std::string& folder, const tile::StoreConfig& config) {
  if (!std::filesystem::exists(std::filesystem::path(folder) / "store.json"))
    return check_outside_stores(folder, "cannot make a store", "give another folder");
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(folder));
  RAYFIELD_ASSIGN(const tile::Snapshot latest, store.latest());
  if (latest.scans.empty() && store.config().crs == config.crs && store.config().tile_size_m == config.tile_size_m)
    return {};
  return fail(ErrorCode::usage, "cannot make a store", folder, "there is one already",
              "see `rayfield status`, or give another folder");
}

// Reads the reference before the store is made: what is wrong with it must not leave a store behind.
Result<Outcome> run_init(const std::string& folder, tile::StoreConfig config, const std::string& reference,
                         const Context& context) {
  RAYFIELD_CHECK(config.validate());
  RAYFIELD_ASSIGN(const CrsInfo crs, lookup_projected_crs(config.crs));
  RAYFIELD_CHECK(check_crs_scale(crs.code));
  config.crs = crs.code;
  RAYFIELD_CHECK(check_free(folder, config));
  std::optional<SurveyedBlock> survey;
  if (!reference.empty()) {
    RAYFIELD_ASSIGN(survey, formats::read_reference_file(reference, config.crs));
    RAYFIELD_CHECK(density::check_survey(*survey));
    RAYFIELD_CHECK(check_place(*survey, crs.code, context.progress));
  }
  density::ImportReport taken;
  if (!context.options.dry_run) {
    RAYFIELD_ASSIGN(tile::Store store, tile::Store::create(folder, config));
    if (survey) {
      RAYFIELD_ASSIGN(taken, density::import_reference(store, *survey, context.command_line));
    }
  }
  Outcome outcome;
  outcome.data = {{"store", folder},
                  {"crs", crs.code},
                  {"crs_name", crs.name},
                  {"tile_size_m", config.tile_size_m},
                  {"dry_run", context.options.dry_run}};
  outcome.text = fmt::format("{} {}: {} ({}), tiles of {} m\n", context.options.dry_run ? "Would make" : "Made", folder,
                             crs.code, crs.name, config.tile_size_m);
  if (!survey) return outcome;
  outcome.data["reference"] = reference;
  if (context.options.dry_run) return outcome;
  outcome.data["rows"] = taken.rows, outcome.data["posts"] = taken.posts;
  outcome.text += fmt::format("{} rows and {} posts of {} rule the layout\n", taken.rows, taken.posts, reference);
  return outcome;
}

}  // namespace

void add_init_command(Commands& commands) {
  const auto folder = std::make_shared<std::string>();
  const auto config = std::make_shared<tile::StoreConfig>();
  const auto reference = std::make_shared<std::string>();
  CLI::App* command = commands.add(
      "init", "Make an empty store for a block", "rayfield init myblock --crs EPSG:7854",
      [folder, config, reference](Context& context) { return run_init(*folder, *config, *reference, context); });
  command->add_option("STORE", *folder, "Folder to make")->required();
  command->add_option("--crs", config->crs, "Projected coordinate reference system in metres, e.g. EPSG:7854")
      ->required();
  command->add_option("--tile-size", config->tile_size_m, "Side of a tile, m")->capture_default_str();
  command->add_option("--reference", *reference,
                      "Surveyed rows (lines) or posts (points) that rule the layout: .gpkg, .geojson or .csv");
}

}  // namespace rayfield::cli
