#include <fmt/core.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <memory>

#include "rayfield/core/date.h"
#include "rayfield/formats/formats.h"
#include "rayfield/tile/tile.h"
#include "text.h"
#include "verbs.h"

namespace rayfield::cli {
namespace {

// What a ray cloud holds: reads it once.
Result<Outcome> inspect_cloud(const std::string& path, const Context& context) {
  RAYFIELD_ASSIGN(const auto reader, formats::PlyReader::open(path, {.allow_truncated = true, .allow_trailing = true}));
  context.progress.stage("reading", reader->ray_count().value_or(0), "rays");
  RayBatch batch;
  std::uint64_t rays = 0, hits = 0;
  double first = std::numeric_limits<double>::infinity(), last = -first;
  Eigen::AlignedBox3d origins, ends;
  while (true) {
    RAYFIELD_ASSIGN(const std::size_t count, reader->read(batch, 131072));
    if (count == 0) break;
    for (std::size_t i = 0; i < count; ++i) {
      hits += batch.hit[i];
      first = std::min(first, batch.time_s[i]), last = std::max(last, batch.time_s[i]);
      origins.extend(batch.origin[i]);
      if (batch.hit[i] != 0) ends.extend(batch.end[i]);
    }
    rays += count;
    context.progress.advance(count);
    if (context.progress.cancelled()) return fail(ErrorCode::interrupted, "interrupted", path, "", "");
  }
  Outcome outcome;
  outcome.data = {
      {"path", path}, {"kind", "ray cloud"}, {"rays", rays}, {"hits", hits}, {"problems", reader->warnings()}};
  if (reader->crs()) outcome.data["crs"] = *reader->crs();
  outcome.text = fmt::format("{}: ray cloud, {} rays, {} hits\n", path, grouped(rays), grouped(hits));
  if (rays > 0) {
    outcome.data["start_utc"] = utc_text(first), outcome.data["end_utc"] = utc_text(last);
    const auto box = [](const Eigen::AlignedBox3d& b) {
      return nlohmann::ordered_json{{"min", {b.min().x(), b.min().y(), b.min().z()}},
                                    {"max", {b.max().x(), b.max().y(), b.max().z()}}};
    };
    outcome.data["origins"] = box(origins);
    if (hits > 0) outcome.data["hit_extent"] = box(ends);
    outcome.text +=
        fmt::format("  from {} to {}\n  sensor between {:.1f} {:.1f} and {:.1f} {:.1f}\n", utc_text(first),
                    utc_text(last), origins.min().x(), origins.min().y(), origins.max().x(), origins.max().y());
  }
  for (const std::string& warning : reader->warnings()) outcome.text += fmt::format("  problem: {}\n", warning);
  return outcome;
}

Result<Outcome> run_info(const std::string& path, const Context& context) {
  if (std::filesystem::is_directory(path)) return store_status(path);
  return inspect_cloud(path, context);
}

}  // namespace

void add_info_verb(Commands& commands) {
  const auto path = std::make_shared<std::string>();
  CLI::App* command =
      commands.add("info", "What is in a ray cloud or a store: counts, times, extents, problems",
                   "rayfield info scan.ply", [path](Context& context) { return run_info(*path, context); });
  command->add_option("CLOUD|STORE", *path, "A ray cloud, or the folder of a store")->required();
}

}  // namespace rayfield::cli
