#include "libtile/store/snapshot_json.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include "libtile/files/store_layout.h"
#include "rayfield/core/date.h"
#include "rayfield/tile/whole_number.h"

namespace rayfield::tile {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSnapshotFormat = "rayfield-snapshot";
constexpr const char* kStoreFormat = "rayfield-store";
constexpr int kVersion = 1;

Json file_json(const FileEntry& file) { return {{"path", file.path}, {"size", file.size}, {"sha256", file.sha256}}; }

Json box_json(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return nullptr;
  return {{"min", {box.min().x(), box.min().y(), box.min().z()}},
          {"max", {box.max().x(), box.max().y(), box.max().z()}}};
}

Json tile_json(const TileEntry& tile) {
  Json files = Json::array({file_json(tile.file)});
  for (const FileEntry& file : tile.more_files) files.push_back(file_json(file));
  return {{"tile", {tile.index.ix, tile.index.iy}},
          {"segments", tile.segment_count},
          {"starts", tile.start_count},
          {"hits", tile.hit_count},
          {"bounds", box_json(tile.bounds)},
          {"files", std::move(files)}};
}

Json derived_json(const DerivedEntry& derived) {
  return {{"kind", derived.kind}, {"name", derived.name}, {"key", derived.key}, {"file", file_json(derived.file)}};
}

// What is not known (NaN) has no place in JSON: the key is left out.
constexpr std::pair<const char*, double ScanAlignment::*> kAlignmentNumbers[] = {
    {"yaw_rad", &ScanAlignment::yaw_rad},
    {"warp_rms_m", &ScanAlignment::warp_rms_m},
    {"residual_m", &ScanAlignment::residual_m},
    {"ground_residual_m", &ScanAlignment::ground_residual_m},
    {"shared_fraction", &ScanAlignment::shared_fraction},
    {"margin", &ScanAlignment::margin}};

constexpr std::pair<AlignmentVerdict, const char*> kVerdicts[] = {{AlignmentVerdict::reference, "reference"},
                                                                  {AlignmentVerdict::aligned, "aligned"},
                                                                  {AlignmentVerdict::unaligned, "unaligned"}};

Json alignment_json(const ScanAlignment& alignment) {
  Json json = {{"verdict", verdict_name(alignment.verdict)},
               {"offset_m", {alignment.offset_m.x(), alignment.offset_m.y(), alignment.offset_m.z()}},
               {"pivot_m", {alignment.pivot_m.x(), alignment.pivot_m.y()}},
               {"landmarks", alignment.landmarks}};
  for (const auto& [key, member] : kAlignmentNumbers)
    if (std::isfinite(alignment.*member)) json[key] = alignment.*member;
  return json;
}

ScanAlignment parse_alignment(const Json& json) {
  ScanAlignment alignment;
  const std::string verdict = json.at("verdict").get<std::string>();
  const auto known = std::find_if(std::begin(kVerdicts), std::end(kVerdicts),
                                  [&](const auto& entry) { return verdict == entry.second; });
  if (known == std::end(kVerdicts)) throw std::runtime_error("alignment '" + verdict + "' is not known");
  alignment.verdict = known->first;
  for (int i = 0; i < 3; ++i) alignment.offset_m[i] = json.at("offset_m").at(i).get<double>();
  for (int i = 0; i < 2; ++i) alignment.pivot_m[i] = json.at("pivot_m").at(i).get<double>();
  if (json.contains("landmarks")) alignment.landmarks = whole_number<int>(json.at("landmarks"));
  for (const auto& [key, member] : kAlignmentNumbers)
    alignment.*member = json.value(key, std::numeric_limits<double>::quiet_NaN());
  return alignment;
}

Json beam_json(const LidarBeam& beam) {
  Json json = {{"diameter_m", beam.diameter_m}, {"divergence_rad", beam.divergence_rad}};
  if (beam.detection_share) json["detection_share"] = *beam.detection_share;
  if (beam.range_resolution_m) json["range_resolution_m"] = *beam.range_resolution_m;
  if (beam.returns) json["returns"] = name_of(*beam.returns);
  return json;
}

LidarBeam parse_beam(const Json& json) {
  LidarBeam beam{.diameter_m = json.at("diameter_m").get<double>(),
                 .divergence_rad = json.at("divergence_rad").get<double>()};
  if (json.contains("detection_share")) beam.detection_share = json.at("detection_share").get<double>();
  if (json.contains("range_resolution_m")) beam.range_resolution_m = json.at("range_resolution_m").get<double>();
  if (json.contains("returns")) {
    const auto name = json.at("returns").get<std::string>();
    beam.returns = return_mode_named(name);
    if (!beam.returns) throw std::runtime_error("'" + name + "' is no echo that a lidar reports");
  }
  return beam;
}

Json scan_json(const ScanEntry& scan) {
  Json inputs = Json::array(), tiles = Json::array(), derived = Json::array(), attachments = Json::array();
  for (const InputEntry& i : scan.inputs) inputs.push_back({{"name", i.name}, {"size", i.size}, {"sha256", i.sha256}});
  for (const TileEntry& t : scan.tiles) tiles.push_back(tile_json(t));
  for (const DerivedEntry& d : scan.derived) derived.push_back(derived_json(d));
  for (const AttachmentEntry& a : scan.attachments)
    attachments.push_back({{"name", a.name}, {"file", file_json(a.file)}});
  Json json = {{"scan_id", scan.scan_id},
               {"date", scan.date},
               {"name", scan.name},
               {"inputs", std::move(inputs)},
               {"rays", scan.ray_count},
               {"hits", scan.hit_count},
               {"start_time_s", scan.start_time_s},
               {"end_time_s", scan.end_time_s},
               {"origin_bounds", box_json(scan.origin_bounds)},
               {"warnings", scan.warnings}};
  if (scan.alignment) json["alignment"] = alignment_json(*scan.alignment);
  if (scan.dormant) json["dormant"] = *scan.dormant;
  if (scan.beam) json["beam"] = beam_json(*scan.beam);
  json["tiles"] = std::move(tiles);
  json["derived"] = std::move(derived);
  json["attachments"] = std::move(attachments);
  return json;
}

FileEntry parse_file(const Json& json) {
  FileEntry file{json.at("path").get<std::string>(), whole_number<std::uint64_t>(json.at("size")),
                 json.at("sha256").get<std::string>()};
  if (!layout::is_inside(file.path)) throw std::runtime_error("path '" + file.path + "' leads out of the store");
  return file;
}

Eigen::AlignedBox3d parse_box(const Json& json) {
  if (json.is_null()) return {};
  const auto corner = [&](const char* key) {
    const Json& c = json.at(key);
    return Eigen::Vector3d(c.at(0).get<double>(), c.at(1).get<double>(), c.at(2).get<double>());
  };
  return {corner("min"), corner("max")};
}

TileEntry parse_tile(const Json& json) {
  TileEntry tile;
  tile.index = {whole_number<std::int32_t>(json.at("tile").at(0)), whole_number<std::int32_t>(json.at("tile").at(1))};
  tile.segment_count = whole_number<std::uint64_t>(json.at("segments"));
  tile.start_count = whole_number<std::uint64_t>(json.at("starts"));
  tile.hit_count = whole_number<std::uint64_t>(json.at("hits"));
  tile.bounds = parse_box(json.at("bounds"));
  const Json& files = json.at("files");
  tile.file = parse_file(files.at(0));
  for (std::size_t i = 1; i < files.size(); ++i) tile.more_files.push_back(parse_file(files.at(i)));
  return tile;
}

DerivedEntry parse_derived(const Json& json) {
  return {json.at("kind").get<std::string>(), json.at("name").get<std::string>(), json.at("key").get<std::string>(),
          parse_file(json.at("file"))};
}

ScanEntry parse_scan(const Json& json) {
  ScanEntry scan;
  scan.scan_id = json.at("scan_id").get<std::string>();
  scan.date = json.at("date").get<std::string>();
  scan.name = json.at("name").get<std::string>();
  for (const Json& i : json.at("inputs"))
    scan.inputs.push_back({i.at("name").get<std::string>(), whole_number<std::uint64_t>(i.at("size")),
                           i.at("sha256").get<std::string>()});
  scan.ray_count = whole_number<std::uint64_t>(json.at("rays"));
  scan.hit_count = whole_number<std::uint64_t>(json.at("hits"));
  scan.start_time_s = json.at("start_time_s").get<double>();
  scan.end_time_s = json.at("end_time_s").get<double>();
  scan.origin_bounds = parse_box(json.at("origin_bounds"));
  scan.warnings = json.at("warnings").get<std::vector<std::string>>();
  if (json.contains("alignment")) scan.alignment = parse_alignment(json.at("alignment"));
  if (const auto dormant = json.find("dormant"); dormant != json.end()) scan.dormant = dormant->get<bool>();
  if (json.contains("beam")) scan.beam = parse_beam(json.at("beam"));
  for (const Json& t : json.at("tiles")) scan.tiles.push_back(parse_tile(t));
  for (const Json& d : json.at("derived")) scan.derived.push_back(parse_derived(d));
  if (json.contains("attachments"))  // stores from before have none
    for (const Json& a : json.at("attachments"))
      scan.attachments.push_back({a.at("name").get<std::string>(), parse_file(a.at("file"))});
  return scan;
}

// A name becomes a folder: what is none, or stands for two things, is not to be written to or deleted.
void check_derived_names(const std::vector<DerivedEntry>& entries) {
  for (const DerivedEntry& entry : entries)
    if (!layout::is_plain_name(entry.kind) || !layout::is_plain_name(entry.name))
      throw std::runtime_error("'" + entry.kind + "/" + entry.name + "' is no name of derived data");
}

void check_names(const Snapshot& snapshot) {
  std::set<std::string> ids;
  for (const ScanEntry& scan : snapshot.scans) {
    if (!layout::is_plain_name(scan.scan_id) || !parse_date(scan.date) || scan.scan_id.substr(0, 10) != scan.date)
      throw std::runtime_error("'" + scan.scan_id + "' of " + scan.date + " is no id of a scan");
    if (!ids.insert(scan.scan_id).second) throw std::runtime_error("scan '" + scan.scan_id + "' stands there twice");
    check_derived_names(scan.derived);
    for (const AttachmentEntry& attachment : scan.attachments)
      if (!layout::is_plain_name(attachment.name))
        throw std::runtime_error("'" + attachment.name + "' is no name of a file kept with a scan");
  }
  check_derived_names(snapshot.registry);
}

// Runs `parse` on a document of that format; whatever is wrong with the document becomes an error.
template <class T, class Parse>
Result<T> parse_document(const Json& json, const char* format, const std::string& where, const Parse& parse) {
  try {
    if (json.at("format") != format)
      return fail(ErrorCode::damaged, "cannot read the store", where, std::string("it is not a ") + format);
    if (whole_number<int>(json.at("version")) > kVersion)
      return fail(ErrorCode::bad_input, "cannot read the store", where,
                  "it was written in format " + std::to_string(whole_number<int>(json.at("version"))) +
                      ", this rayfield knows format " + std::to_string(kVersion),
                  "use a newer rayfield");
    return parse();
  } catch (const std::exception& e) {
    return fail(ErrorCode::damaged, "cannot read the store", where, e.what(), "run `rayfield verify`");
  }
}

}  // namespace

std::string verdict_name(AlignmentVerdict verdict) {
  for (const auto& [value, name] : kVerdicts)
    if (value == verdict) return name;
  return {};
}

Json to_json(const Snapshot& snapshot) {
  Json scans = Json::array(), registry = Json::array();
  for (const ScanEntry& scan : snapshot.scans) scans.push_back(scan_json(scan));
  for (const DerivedEntry& derived : snapshot.registry) registry.push_back(derived_json(derived));
  Json json = {{"format", kSnapshotFormat},           {"version", kVersion},
               {"number", snapshot.number},           {"parent", snapshot.parent},
               {"created_utc", snapshot.created_utc}, {"software_version", snapshot.software_version},
               {"command", snapshot.command}};
  for (const SnapshotRange& range : snapshot.lost) json["lost"].push_back({range.first, range.last});
  json["scans"] = std::move(scans);
  json["registry"] = std::move(registry);
  return json;
}

Result<Snapshot> snapshot_from_json(const Json& json, const std::string& where) {
  return parse_document<Snapshot>(json, kSnapshotFormat, where, [&] {
    Snapshot snapshot;
    snapshot.number = whole_number<std::uint64_t>(json.at("number"));
    snapshot.parent = whole_number<std::uint64_t>(json.at("parent"));
    snapshot.created_utc = json.at("created_utc").get<std::string>();
    snapshot.software_version = json.at("software_version").get<std::string>();
    snapshot.command = json.at("command").get<std::string>();
    if (json.contains("lost"))
      for (const Json& range : json.at("lost"))
        snapshot.lost.push_back({whole_number<std::uint64_t>(range.at(0)), whole_number<std::uint64_t>(range.at(1))});
    for (const Json& scan : json.at("scans")) snapshot.scans.push_back(parse_scan(scan));
    for (const Json& derived : json.at("registry")) snapshot.registry.push_back(parse_derived(derived));
    check_names(snapshot);
    return snapshot;
  });
}

std::optional<ScanAlignment> alignment_from_file(const std::string& text) {
  try {
    return parse_alignment(Json::parse(text));
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

Json to_json(const StoreConfig& config) {
  return {{"format", kStoreFormat},
          {"version", kVersion},
          {"crs", config.crs},
          {"tile_size_m", config.tile_size_m},
          {"tile_margin_m", config.tile_margin_m}};
}

Result<StoreConfig> config_from_json(const Json& json, const std::string& where) {
  return parse_document<StoreConfig>(json, kStoreFormat, where, [&] {
    StoreConfig config;
    config.crs = json.at("crs").get<std::string>();
    config.tile_size_m = json.at("tile_size_m").get<double>();
    config.tile_margin_m = json.at("tile_margin_m").get<double>();
    return config;
  });
}

}  // namespace rayfield::tile
