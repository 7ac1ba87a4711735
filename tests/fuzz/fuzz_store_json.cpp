#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "libtile/files/sealed_json.h"
#include "libtile/store/snapshot_json.h"
#include "rayfield/core/sha256.h"

namespace {

using namespace rayfield::tile;

/// A document whose seal fits, whatever its body.
std::string sealed(const std::string& what, const std::string& body) {
  return "{\"sha256\": \"" + rayfield::sha256_hex(body) + "\",\n\"" + what + "\": " + body + "}\n";
}

/// Nothing that a snapshot names leads out of its store.
void expect_within_store(const Snapshot& snapshot) {
  for (const FileEntry* file : snapshot.files()) {
    const std::filesystem::path path = file->path;
    if (path.empty() || path.is_absolute()) std::abort();
    for (const auto& part : path) {
      if (part == ".." || part == "." || part.empty()) std::abort();
    }
  }
  for (const ScanEntry& scan : snapshot.scans) {
    if (scan.scan_id.empty() || scan.scan_id.front() == '.' || scan.scan_id.find('/') != std::string::npos)
      std::abort();
  }
}

}  // namespace

/// Whatever the body of a snapshot or of store.json: an error, or values that stay within the store and survive being
/// written and read again. Attachments are read the same way.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string body(reinterpret_cast<const char*>(data), size);
  if (const auto json = unseal_json("snapshot", sealed("snapshot", body), "fuzz")) {
    if (const auto snapshot = snapshot_from_json(*json, "fuzz")) {
      expect_within_store(*snapshot);
      const auto written = to_json(*snapshot);
      const auto again = snapshot_from_json(written, "again");
      if (!again || to_json(*again) != written) std::abort();
    }
  }
  if (const auto json = unseal_json("store", sealed("store", body), "fuzz")) {
    if (const auto config = config_from_json(*json, "fuzz")) {
      const auto again = config_from_json(to_json(*config), "again");
      if (!again || again->crs != config->crs) std::abort();
    }
  }
  (void)alignment_from_file(body);
  return 0;
}
