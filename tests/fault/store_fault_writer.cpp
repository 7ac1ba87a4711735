// Makes a store, or opens it, and commits to it: `store_fault_writer STORE add|add:DATE|scatter|derive|remove|revert`.
// The exit code is that of the error, which is printed. The same arguments always ask for the same result.
#include <cmath>
#include <cstdio>
#include <string>

#include "rayfield/core/ray_source.h"
#include "rayfield/core/sha256.h"
#include "rayfield/tile/tile.h"

namespace {

using namespace rayfield;

class SmallScan : public RaySource {
 public:
  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override {
    batch.clear();
    for (; next_ < kRays && batch.size() < max_rays; ++next_) {
      const double i = static_cast<double>(next_);
      const Eigen::Vector3d origin(276220.0 + 0.01 * i, 6099990.0, 80.0);
      batch.push(origin, origin + Eigen::Vector3d(9 * std::sin(i), 9 * std::cos(i), 0.5), 1.5e9 + 1e-4 * i, 5, true);
    }
    return batch.size();
  }
  Result<bool> rewind() override { return false; }
  std::string name() const override { return "small scan"; }

 private:
  static constexpr std::size_t kRays = 3000;
  std::size_t next_ = 0;
};

// More rays, in no order, than the smallest buffers hold.
class ScatteredScan : public RaySource {
 public:
  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override {
    batch.clear();
    for (; next_ < kRays && batch.size() < max_rays; ++next_) {
      const double x = static_cast<double>(next_ * 7919 % 100003) / 500,
                   y = static_cast<double>(next_ * 104729 % 100019) / 500;
      const Eigen::Vector3d origin(276220.0 + x, 6099990.0 + y, 80.0);
      batch.push(origin, origin + Eigen::Vector3d(1 + x / 100, y / 100, 0.5), 1.5e9, 5, true);
    }
    return batch.size();
  }
  Result<bool> rewind() override { return false; }
  std::string name() const override { return "scattered scan"; }

 private:
  static constexpr std::size_t kRays = 1600000;
  std::size_t next_ = 0;
};

Result<void> add(tile::Store& store, RaySource&& rays, const std::string& date = "2019-02-11") {
  tile::AddOptions options;
  options.date = date;
  options.threads = 1;
  options.memory_bytes = std::uint64_t{128} << 20;
  options.command = "add";
  options.inputs = {{"small.ply", 1, sha256_hex("small")}};
  options.attachments = {{"slam.json", std::string(5000, 'j')}, {"trajectory.tum.bz2", std::string(300000, 't')}};
  Progress progress;
  RAYFIELD_CHECK(store.add(rays, options, progress));
  return {};
}

Result<void> derive(tile::Store& store) {
  RAYFIELD_ASSIGN(tile::Store::DerivedWriter writer, store.write_derived());
  std::vector<tile::DerivedEntry> keep;
  for (const char* name : {"west", "east"}) {
    tile::ArraySet arrays;
    arrays.kind = "ground";
    arrays.columns["z"] = std::vector<double>(500, name[0] == 'w' ? 1.0 : 2.0);
    const tile::NewDerived what{"2019-02-11", "ground", name, sha256_hex(std::string(name))};
    RAYFIELD_ASSIGN(tile::DerivedEntry entry, writer.put(what, arrays));
    keep.push_back(std::move(entry));
  }
  tile::ArraySet rows;
  rows.kind = "rows";
  rows.columns["x"] = std::vector<double>{1, 2, 3};
  RAYFIELD_ASSIGN(tile::DerivedEntry entry, writer.put({"", "rows", "block", sha256_hex("rows")}, rows));
  RAYFIELD_CHECK(writer.set("2019-02-11", keep));
  RAYFIELD_CHECK(writer.set("", {entry}));
  RAYFIELD_CHECK(writer.commit("process"));
  return {};
}

Result<void> run(const std::string& folder, const std::string& what) {
  tile::StoreConfig config;
  config.crs = "EPSG:7854";
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::create(folder, config));
  if (what == "add") return add(store, SmallScan());
  if (what.starts_with("add:")) return add(store, SmallScan(), what.substr(4));
  if (what == "scatter") return add(store, ScatteredScan());
  if (what == "remove") {
    RAYFIELD_CHECK(store.remove("2019-02-11", "remove"));
    return {};
  }
  if (what == "revert") {
    RAYFIELD_CHECK(store.revert(1, "revert"));
    return {};
  }
  return derive(store);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const Result<void> result = run(argv[1], argv[2]);
  if (result) return 0;
  std::fprintf(stderr, "%s\n", result.error().line().c_str());
  return static_cast<int>(result.error().code);
}
