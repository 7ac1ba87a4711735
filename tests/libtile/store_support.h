#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "rayfield/core/ray_source.h"
#include "rayfield/tile/tile.h"

namespace rayfield::tile::testing {

namespace fs = std::filesystem;

/// A folder that lives as long as the test.
class ScratchFolder {
 public:
  ScratchFolder() : ScratchFolder(fs::temp_directory_path()) {}
  explicit ScratchFolder(const fs::path& parent) {
    std::string name = (parent / "rayfield-tile-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create a scratch folder");
    path_ = name;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Rays from memory; can pretend not to know its length, and to fail or to be followed by a call after some rays.
class MemorySource : public RaySource {
 public:
  explicit MemorySource(RayBatch rays) : rays_(std::move(rays)) {}
  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override {
    batch.clear();
    if (fail_after && next_ >= *fail_after)
      return fail(ErrorCode::bad_input, "cannot read ray cloud", name(), "made to fail");
    for (std::size_t n = 0; n < std::min(max_rays, most_at_once) && next_ < rays_.size(); ++n, ++next_)
      batch.push(rays_.origin[next_], rays_.end[next_], rays_.time_s[next_], rays_.intensity[next_],
                 rays_.hit[next_] != 0);
    return batch.size();
  }
  Result<bool> rewind() override {
    ++rewinds;
    return false;
  }
  std::optional<std::uint64_t> ray_count() const override {
    return knows_count ? std::optional<std::uint64_t>(rays_.size()) : std::nullopt;
  }
  std::string name() const override { return "memory"; }
  std::vector<std::string> warnings() const override { return source_warnings; }

  std::size_t most_at_once = 1 << 20;
  bool knows_count = true;
  std::optional<std::size_t> fail_after;
  std::vector<std::string> source_warnings;
  int rewinds = 0;

 private:
  RayBatch rays_;
  std::size_t next_ = 0;
};

inline constexpr double kEast = 276196.0, kNorth = 6099944.0, kTime = 1549843200.0;

/// A spinning 2D lidar on a vehicle: half of the rays hit something at a noisy range, half go 40 m into the sky.
inline RayBatch simulated_drive(std::size_t count, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  RayBatch rays;
  rays.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / 28600.0;
    const double spin = std::numbers::pi * t, beam = 2 * std::numbers::pi * static_cast<double>(i % 286) / 286.0;
    const Eigen::Vector3d direction(std::cos(beam) * std::cos(spin), std::cos(beam) * std::sin(spin), std::sin(beam));
    const Eigen::Vector3d origin(kEast + 1.2 * t + 0.02 * std::sin(9 * t), kNorth + 0.3 * t,
                                 82.0 + 0.02 * std::sin(7 * t));
    const bool hit = direction.z() <= 0 || uniform(random) < 0.1;
    const double range = hit ? 1.0 + 8.0 * uniform(random) * uniform(random) + noise(random) : 40.0;
    rays.push(origin, origin + range * direction, kTime + t,
              hit ? static_cast<std::uint16_t>(100 + 155 * uniform(random)) : 0, hit);
  }
  return rays;
}

/// Rays of a few metres anywhere in a square, in no order.
inline RayBatch scattered_rays(std::size_t count, double side_m, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0.0, side_m), step(-8.0, 8.0);
  RayBatch rays;
  rays.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d origin(kEast + place(random), kNorth + place(random), 80.0);
    rays.push(origin, origin + Eigen::Vector3d(step(random), step(random), 0.2 * step(random)),
              kTime + 1e-4 * static_cast<double>(i), static_cast<std::uint16_t>(i % 256), i % 2 == 0);
  }
  return rays;
}

inline StoreConfig test_config() {
  StoreConfig config;
  config.crs = "EPSG:7854";
  return config;
}

inline Store make_store(const fs::path& folder, const StoreConfig& config = test_config()) {
  auto store = Store::create(folder, config);
  if (!store) throw std::runtime_error(store.error().line());
  return *store;
}

inline AddOptions add_options(const std::string& date = "2019-02-11") {
  AddOptions options;
  options.date = date;
  options.threads = 2;
  options.memory_bytes = std::uint64_t{128} << 20;
  options.command = "rayfield add";
  options.inputs = {{"cloud-" + date + ".ply", 42, std::string(64, 'a')}};
  return options;
}

inline Result<AddReport> add(Store& store, RayBatch rays, const AddOptions& options = add_options()) {
  MemorySource source(std::move(rays));
  Progress progress;
  return store.add(source, options, progress);
}

inline SegmentBatch read_tile(const Store& store, const TileEntry& tile) {
  SegmentBatch all, chunk;
  auto reader = store.open_tile(tile);
  if (!reader) throw std::runtime_error(reader.error().line());
  for (std::size_t c = 0; c < reader->chunk_count(); ++c) {
    if (const auto read = reader->read_chunk(c, chunk); !read) throw std::runtime_error(read.error().line());
    EXPECT_EQ(chunk.size(), reader->chunk_size(c));
    all.entry.insert(all.entry.end(), chunk.entry.begin(), chunk.entry.end());
    all.exit.insert(all.exit.end(), chunk.exit.begin(), chunk.exit.end());
    all.time_s.insert(all.time_s.end(), chunk.time_s.begin(), chunk.time_s.end());
    all.intensity.insert(all.intensity.end(), chunk.intensity.begin(), chunk.intensity.end());
    all.flags.insert(all.flags.end(), chunk.flags.begin(), chunk.flags.end());
  }
  return all;
}

inline std::string file_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_text(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

/// All files of a store with their bytes, without the lock.
inline std::map<std::string, std::string> contents(const fs::path& store) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(store)) {
    if (entry.is_regular_file() && entry.path().filename() != "lock")
      files[entry.path().lexically_relative(store).generic_string()] = file_text(entry.path());
  }
  return files;
}

inline std::vector<Damage> damage_of(const Store& store, bool all = true) {
  Progress progress;
  auto damage = store.verify(all, 2, progress);
  if (!damage) throw std::runtime_error(damage.error().line());
  return *damage;
}

inline void flip_bit(const fs::path& path, std::size_t offset, unsigned char bit = 4) {
  std::string bytes = file_text(path);
  bytes.at(offset) = static_cast<char>(static_cast<unsigned char>(bytes.at(offset)) ^ bit);
  write_text(path, bytes);
}

}  // namespace rayfield::tile::testing
