#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "rayfield/tile/store.h"
#include "tests/fault/damage.h"

namespace rayfield::tile::testing {

/// What a campaign has done and found. Kinds of files are folders of scans ("rays", "ground", "files"), "registry",
/// "snapshots", "store.json" and "lock".
struct DamageTally {
  std::map<std::string, std::size_t> damages;  ///< by kind
  std::vector<std::string> findings;           ///< each begins with "wrong: " or "unclear: "
};

/// Damages files of a store, one of each kind after the other, and uses the store as the program does. What is damaged
/// has to be named by verify() and refused by whoever reads it, and nothing else; the history tells what it told before
/// or nothing. The store is whole again after each round. Its newest snapshot must be sound, and its note in `lock`.
class DamageCampaign {
 public:
  /// `spare`: a folder that is made, for a copy of what tells the history.
  DamageCampaign(const std::filesystem::path& store, const std::filesystem::path& spare);
  DamageCampaign(const DamageCampaign&) = delete;
  DamageCampaign& operator=(const DamageCampaign&) = delete;
  ~DamageCampaign();

  /// At least so many damages. `announce` is told of each before the store is used.
  DamageTally run(std::size_t damages, std::uint64_t seed,
                  const std::function<void(const std::string&)>& announce) const;
  /// Puts back every file, also after a process that ran the campaign has died.
  void restore() const;

 private:
  using Entry = std::variant<TileEntry, DerivedEntry, AttachmentEntry>;
  struct Hurt {
    std::string path, what;
  };
  void take_entries(const Snapshot& snapshot);
  std::vector<Hurt> hurt_some(std::size_t first_kind, std::mt19937_64& random) const;
  void use_data(const std::vector<Hurt>& hurt, DamageTally& tally) const;
  void read_hurt(const Store& store, const Hurt& hurt, DamageTally& tally) const;
  void use_history(const std::string& path, const DamagedFile& file, DamageTally& tally) const;
  void use_snapshots(const Store& store, const std::string& path, const DamagedFile& file, DamageTally& tally) const;

  std::filesystem::path store_, spare_;
  std::map<std::string, std::string> files_;               // all of the store, by path
  std::map<std::string, Entry> entries_;                   // what names the data, by path
  std::map<std::string, std::vector<std::string>> kinds_;  // paths of data
  std::vector<std::string> history_;                       // paths of the rest
  std::map<std::string, std::uint64_t> numbers_;           // of snapshots, by path
  std::string latest_;                                     // the newest one, as text
};

}  // namespace rayfield::tile::testing
