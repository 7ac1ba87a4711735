#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "cli/commands/commands.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/tile/tile.h"

namespace rayfield::cli {
namespace {

Result<Outcome> run_init(const std::string& folder, const tile::StoreConfig& config, const Context& context) {
  RAYFIELD_CHECK(config.validate());
  RAYFIELD_ASSIGN(const CrsInfo crs, lookup_projected_crs(config.crs));
  if (std::filesystem::exists(std::filesystem::path(folder) / "store.json"))
    return fail(ErrorCode::usage, "cannot make a store", folder, "there is one already",
                "see `rayfield status`, or give another folder");
  if (!context.options.dry_run) RAYFIELD_CHECK(tile::Store::create(folder, config));
  Outcome outcome;
  outcome.data = {{"store", folder},
                  {"crs", crs.code},
                  {"crs_name", crs.name},
                  {"tile_size_m", config.tile_size_m},
                  {"dry_run", context.options.dry_run}};
  outcome.text = fmt::format("{} {}: {} ({}), tiles of {} m\n", context.options.dry_run ? "Would make" : "Made", folder,
                             crs.code, crs.name, config.tile_size_m);
  return outcome;
}

}  // namespace

void add_init_command(Commands& commands) {
  const auto folder = std::make_shared<std::string>();
  const auto config = std::make_shared<tile::StoreConfig>();
  CLI::App* command = commands.add("init", "Make an empty store for a block", "rayfield init myblock --crs EPSG:7854",
                                   [folder, config](Context& context) { return run_init(*folder, *config, context); });
  command->add_option("STORE", *folder, "Folder to make")->required();
  command->add_option("--crs", config->crs, "Projected coordinate reference system in metres, e.g. EPSG:7854")
      ->required();
  command->add_option("--tile-size", config->tile_size_m, "Side of a tile, m")->capture_default_str();
}

}  // namespace rayfield::cli
