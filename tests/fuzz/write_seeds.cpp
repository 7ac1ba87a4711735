// Writes small sound inputs for every fuzz target: write_seeds FOLDER makes FOLDER/<target>/<name>.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "libtile/hdf5/array_image.h"
#include "libtile/hdf5/seal.h"
#include "libtile/store/snapshot_json.h"
#include "libtile/tile_file/tile_file.h"
#include "rayfield/formats/ply_writer.h"
#include "rayfield/formats/registry_file.h"
#include "rayfield/formats/rig_file.h"
#include "rayfield/formats/sensor_log_writer.h"
#include "rayfield/formats/trajectory_file.h"
#include "tests/formats/las_support.h"
#include "tests/fuzz/derived_seeds.h"

namespace {

using namespace rayfield;
namespace fs = std::filesystem;

constexpr const char* kCrs = "EPSG:7854";

void write_bytes(const fs::path& path, std::span<const std::byte> bytes) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}
void write_text(const fs::path& path, const std::string& text) { write_bytes(path, std::as_bytes(std::span(text))); }

std::span<const std::byte> unsealed(std::span<const std::byte> file) {
  return file.first(file.size() - tile::kSealSize);
}

// Chunks of 16 elements, so that a file of several chunks is small.
void write_tile(const fs::path& path, std::size_t segments) {
  tile::TilePartHeader header;
  header.index = {11047, 243997};
  header.segments = segments;
  tile::StoreConfig config;
  config.crs = kCrs;
  const tile::TileGrid grid(config);
  header.size = grid.size, header.margin = grid.margin;
  const std::size_t elements = std::min<std::size_t>(segments, 16);
  std::vector<tile::EncodedChunk> chunks;
  for (std::size_t first = 0; first < segments; first += elements) {
    std::vector<tile::RayRecord> records;
    for (std::size_t i = first; i < std::min(first + elements, segments); ++i) {
      const auto n = static_cast<std::int32_t>(i);
      records.push_back({{{1000 * n, 2000, 820000}, {-90000 + 500 * n, 400 * n, 3000}}, 1000U + 35U * n, 3, 7, 3, 0});
    }
    chunks.push_back(tile::encode_chunk(records, elements));
  }
  write_bytes(path, unsealed(tile::build_tile_part(header, chunks).value()));
}

void write_arrays(const fs::path& folder) {
  tile::ArraySet arrays;
  arrays.kind = "voxels";
  arrays.attributes = R"({"voxel_m": 0.12})";
  write_bytes(folder / "without_columns", unsealed(tile::encode_arrays(arrays).value()));
  arrays.columns["u8"] = std::vector<std::uint8_t>{0, 255};
  arrays.columns["u16"] = std::vector<std::uint16_t>{65535, 1};
  arrays.columns["i32"] = std::vector<std::int32_t>{-5, 5};
  arrays.columns["u32"] = std::vector<std::uint32_t>{5, 6};
  arrays.columns["i64"] = std::vector<std::int64_t>{-1, 1};
  arrays.columns["f32"] = std::vector<float>{1.5F, -0.0F};
  arrays.columns["f64"] = std::vector<double>{0.1, 5e-324};
  arrays.columns["empty"] = std::vector<double>{};
  write_bytes(folder / "all_types", unsealed(tile::encode_arrays(arrays).value()));
  for (int i = 0; i < 20; ++i) arrays.columns["column" + std::to_string(i)] = std::vector<float>{0.5F};
  write_bytes(folder / "many_columns", unsealed(tile::encode_arrays(arrays).value()));
  arrays.columns.clear();
  arrays.columns["two_chunks"] = std::vector<std::uint8_t>(140000, 5);
  write_bytes(folder / "two_chunks", unsealed(tile::encode_arrays(arrays).value()));
}

void write_store_json(const fs::path& folder) {
  tile::StoreConfig config;
  config.crs = kCrs;
  write_text(folder / "store", tile::to_json(config).dump(1));
  tile::Snapshot snapshot;
  snapshot.number = 7, snapshot.parent = 6;
  snapshot.created_utc = "2019-02-11T00:00:00.000Z", snapshot.software_version = "0.1.0", snapshot.command = "add";
  snapshot.lost = {{2, 3}};
  tile::ScanEntry scan;
  scan.scan_id = "2019-02-11_a", scan.date = "2019-02-11", scan.name = "a";
  scan.inputs = {{"a.ply", 123, "ab"}};
  scan.ray_count = 10, scan.hit_count = 4;
  scan.origin_bounds.extend(Eigen::Vector3d(1.1, 2.2, 3.3));
  scan.warnings = {"3 rays dropped"};
  scan.alignment.emplace();
  scan.dormant = true;
  scan.beam = LidarBeam{0.01, 0.002, 0.1, 0.3, ReturnMode::strongest};
  tile::TileEntry tile;
  tile.index = {-3, 7};
  tile.file = {"scans/2019-02-11_a/rays/a.h5", 5, "cd"};
  tile.more_files = {{"scans/2019-02-11_a/rays/b.h5", 6, "ef"}};
  tile.segment_count = 9, tile.start_count = 8, tile.hit_count = 3;
  scan.tiles = {tile};
  scan.derived = {{"ground", "block", "key", {"scans/2019-02-11_a/ground/c.h5", 1, "01"}}};
  scan.attachments = {{"slam.json", {"scans/2019-02-11_a/files/slam.e.json", 3, "03"}}};
  snapshot.scans = {scan};
  snapshot.registry = {{"rows", "block", "key", {"registry/rows/d.h5", 2, "02"}}};
  write_text(folder / "snapshot", tile::to_json(snapshot).dump(1));
  write_text(folder / "alignment", R"({"verdict": "aligned", "offset_m": [0.1, 0.2, 0.3], "pivot_m": [1, 2],
    "yaw_rad": 0.01, "warp_rms_m": 0.02, "landmarks": 31})");
}

Rig rig_with_everything() {
  Rig rig;
  rig.spinner = Rig::Spinner();
  rig.gps = Rig::Gps();
  return rig;
}

Result<void> write_cloud(const fs::path& path) {
  fs::create_directories(path.parent_path());
  formats::PlyWriteOptions options;
  options.crs = kCrs;
  options.beam = LidarBeam{0.01, 0.002, 0.1, 0.3, ReturnMode::strongest};
  RAYFIELD_ASSIGN(auto writer, formats::PlyWriter::create(path.string(), options));
  RayBatch rays;
  for (int i = 0; i < 5; ++i)
    rays.push({276196.0 + i, 6099944.0, 82}, {276199.0, 6099940.0 - i, 81}, 1e9 + i, 100, true);
  RAYFIELD_CHECK(writer.write(rays));
  return writer.close();
}

Result<void> write_trajectories(const fs::path& folder) {
  fs::create_directories(folder);
  formats::TrajectoryFile trajectory{{}, kCrs, "IMU"};
  for (int i = 0; i < 4; ++i)
    trajectory.poses.push_back(
        {1.5e9 + 0.01 * i, Rigid3{Eigen::Quaterniond::Identity(), {276196.0 + i, 6099944.0, 82}}});
  RAYFIELD_CHECK(formats::write_trajectory((folder / "text").string(), trajectory));
  RAYFIELD_ASSIGN(const std::string packed, formats::pack_trajectory(trajectory));
  write_text(folder / "packed", packed);
  write_text(folder / "table",
             "GPS Time [s];Easting;Northing;Height;qx;qy;qz;qw\n10;1;2;3;0;0;0;1\n11;2;3;4;0;0;1;0\n");
  write_text(folder / "columns", "%time x y z userfields\n10 1 2 3 0\n11 4 5 6 0\n");
  return {};
}

// Points of the drive that fuzz_las.cpp knows, of every layout of their records, and with every kind of CRS.
void write_las_clouds(const fs::path& folder) {
  using formats::bytes::LasSpec;
  for (const auto& [minor, format] : {std::pair{2, 1}, {2, 3}, {3, 4}, {4, 6}, {4, 10}}) {
    LasSpec spec;
    spec.minor = minor, spec.format = format, spec.offset = {276000, 6099000, 80}, spec.extra_bytes = format % 3;
    for (int i = 0; i < 20; ++i) {
      formats::bytes::LasTestPoint point;
      point.position = spec.offset + Eigen::Vector3d(i, 3, 1);
      point.time_s = 1625097600.0 - 1315964800.0 + 18 + 2.5 * i;
      point.return_number = 1 + i % 2, point.returns = 2, point.withheld = i == 4, point.synthetic = i == 6;
      point.classification = i == 8 ? 7 : 2;
      spec.points.push_back(point);
    }
    if (minor == 2) spec.records = {formats::bytes::geokeys({{1024, 0, 1, 1}, {3072, 0, 1, 7854}})};
    const std::string wkt = "PROJCS[\"a\",GEOGCS[\"b\",DATUM[\"c\",SPHEROID[\"d\",6378137,298.257]],PRIMEM[\"e\",0]]]";
    if (minor == 3) spec.encoding = 17, spec.records = {formats::bytes::las_record("LASF_Projection", 2112, wkt)};
    if (minor == 4) spec.encoding = 17, spec.extended_count = 1;
    if (minor == 4) spec.extended = formats::bytes::extended_las_record("LASF_Projection", 2112, wkt);
    write_text(folder / ("format_" + std::to_string(format)), formats::bytes::las_bytes(spec));
  }
}

Result<void> write_bag(const fs::path& path, formats::BagCompression compression) {
  fs::create_directories(path.parent_path());
  formats::BagWriteOptions options;
  options.compression = compression;
  options.chunk_bytes = 4096;
  RAYFIELD_ASSIGN(auto writer, formats::SensorLogWriter::create(path.string(), rig_with_everything(), options));
  const formats::ScanPattern pattern{20, -1.5, 0.1, 1e-4, 0.025, 0.1, 30};
  for (int i = 0; i < 4; ++i) {
    const double time_s = 1.5e9 + 0.01 * i;
    RAYFIELD_CHECK(writer.imu({time_s, {0, 0, 0.1}, {0, 0, 9.81}}));
    RAYFIELD_CHECK(writer.gps({time_s, -34.9, 138.6, 80, Eigen::Matrix3d::Identity(), 0, 2}));
    RAYFIELD_CHECK(writer.spinner({time_s, 0.1 * i}, 3));
    RAYFIELD_CHECK(writer.scan(time_s, pattern, std::vector<float>(20, 4.5F), std::vector<float>(20, 90.0F)));
  }
  return writer.close();
}

Result<void> write_multi_echo_bag(const fs::path& path) {
  RAYFIELD_ASSIGN(auto writer, formats::SensorLogWriter::create(path.string(), rig_with_everything()));
  LidarScan scan;
  scan.range_m.assign(20, 4.5F), scan.intensity.assign(20, 90.0F);
  scan.later = {{2, 5.5F, 30.0F}, {2, 7.0F, 20.0F}, {9, 5.0F, 40.0F}};
  for (int i = 0; i < 4; ++i) {
    scan.time_s = 1.5e9 + 0.01 * i;
    RAYFIELD_CHECK(writer.imu({scan.time_s, {0, 0, 0.1}, {0, 0, 9.81}}));
    RAYFIELD_CHECK(writer.multi_echo_scan({20, -1.5, 0.1, 1e-4, 0.025, 0.1, 30}, scan));
  }
  return writer.close();
}

// The first byte chooses the kind of file: fuzz_reference.cpp.
void write_references(const fs::path& folder) {
  write_text(folder / "geojson", std::string(1, '\0') + R"({"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"row": 1, "row_name": "a"}, "geometry": {"type": "LineString",
"coordinates": [[138.55, -35.21], [138.5501, -35.21]]}},
{"type": "Feature", "properties": {"row": 1, "height_m": 1.9}, "geometry": {"type": "Point",
"coordinates": [138.55, -35.21]}}]})");
  write_text(folder / "csv",
             "\x01kind,row,name,easting,northing,height_m,valid_to\n"
             "row,1,a,276196,6099944,,\nrow,1,a,276206,6099944,,\npost,1,,276196,6099944,1.9,\n");
  write_text(folder / "csv_degrees", "\x01longitude,latitude,row\n138.55,-35.21,1\n");
  const fs::path file = folder / "reference.gpkg";
  BlockProducts block;
  block.crs = kCrs;
  block.rows.emplace_back();
  block.rows[0].centreline = {{276196, 6099944}, {276206, 6099944}};
  if (!formats::write_registry_file(block, file.string())) return;
  std::ifstream in(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  fs::remove(file);
  write_text(folder / "gpkg", "\x02" + bytes);
}

void write_texts(const fs::path& folder) {
  write_text(folder / "fuzz_block_list" / "list", R"([[block]]
store = "north"
inputs = ["a.bag", "b.bag"]
rig = "rig.toml"
date = 2019-02-11
name = "veraison"
output = "maps"
crs = "EPSG:7854"
set = ["posts.panel_length_m=7.5"]
)");
  write_text(folder / "fuzz_config" / "config", R"(threads = 2
[process]
panel-length = 7.5
date = ["2019-02-11", "2019-02-12"]
overwrite = true
[process.posts]
min_contrast = 2.5
[gc]
)");
  write_text(folder / "fuzz_site" / "site", R"([site]
name = "fuzz"
latitude_deg = 47.3
longitude_deg = 8.4
seed = 5
[terrain]
slope_percent = 3
[rows]
count = 2
length_m = 14
spacing_m = 2.5
azimuth_deg = 70
panel_length_m = 3.5
[canopy]
leaf_area_m2_per_m = 1.8
[surroundings]
trees = 1
buildings = 0
fence = false
[spinning]
beams = 143
[[date]]
date = "2021-03-01"
leaf_fraction = 0.0
)");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: write_seeds FOLDER\n", stderr), 2;
  const fs::path folder = argv[1];
  for (const std::size_t segments : {1, 16, 40}) write_tile(folder / "fuzz_tile" / std::to_string(segments), segments);
  write_arrays(folder / "fuzz_arrays");
  write_store_json(folder / "fuzz_store_json");
  for (const auto& [name, bytes] : fuzz::derived_seeds()) write_text(folder / "fuzz_derived" / name, bytes);
  write_text(folder / "fuzz_rig" / "everything", formats::rig_text(rig_with_everything()));
  write_text(folder / "fuzz_rates" / "commas", "zone,rate\n1,400\n2,250.5\n3,0\n");
  write_text(folder / "fuzz_rates" / "semicolons", "\"rate\";\"zone\"\r\n\"1e2\";\"3\"\r\n7;1\r\n0.5;2\r\n");
  write_references(folder / "fuzz_reference");
  write_texts(folder);
  write_las_clouds(folder / "fuzz_las");
  auto written = write_cloud(folder / "fuzz_ply" / "cloud");
  if (written) written = write_trajectories(folder / "fuzz_trajectory");
  using formats::BagCompression;
  for (const auto compression : {BagCompression::none, BagCompression::bz2, BagCompression::lz4}) {
    if (written)
      written = write_bag(folder / "fuzz_rosbag" / std::to_string(static_cast<int>(compression)), compression);
    if (written) written = write_multi_echo_bag(folder / "fuzz_rosbag" / "multi_echo");
  }
  if (!written) return std::fprintf(stderr, "%s\n", written.error().line().c_str()), 1;
  return 0;
}
