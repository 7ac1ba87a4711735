#include "rayfield/density/registry.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>

#include "libdensity/layout/polyline.h"
#include "libdensity/registry/identity.h"
#include "libdensity/registry/layout_arrays.h"
#include "libdensity/registry/layout_products.h"
#include "libdensity/registry/layout_store.h"
#include "libdensity/registry/survey_layout.h"
#include "libdensity/tiles/derive.h"

namespace rayfield::density {
namespace {

constexpr const char* kRename = "cannot rename";
constexpr const char* kImport = "cannot use the reference";
constexpr std::size_t kLongestName = 80;
constexpr double kOutlineHalfWidth = 0.25;  // m; of panels whose canopy nobody has measured yet

// True where every row of the survey runs in the layout as it was surveyed: the layout was made from this survey.
bool made_from(const RowLayout& layout, const RowLayout& survey) {
  return std::all_of(survey.rows.begin(), survey.rows.end(), [&](const Row& surveyed) {
    return std::any_of(layout.rows.begin(), layout.rows.end(), [&](const Row& row) {
      return row.identity.uid == surveyed.identity.uid && row.centreline == surveyed.centreline;
    });
  });
}

// The layout of today; a survey that no scan has been processed with yet goes before an older layout.
Result<BlockLayout> current_layout(const tile::Store& store, const tile::Snapshot& snapshot) {
  RAYFIELD_ASSIGN(BlockLayout layout, read_layout(store, snapshot));
  RAYFIELD_ASSIGN(BlockLayout survey, read_survey(store, snapshot));
  if (survey.known && (!layout.known || !made_from(layout.layout, survey.layout))) return survey;
  return layout;
}

Result<void> check_name(const std::string& name, bool names_files) {
  const bool plain = std::none_of(name.begin(), name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  const bool good = plain && name.size() <= kLongestName &&
                    (!names_files || (!name.empty() && name.front() != '.' && name.find('/') == std::string::npos));
  if (good) return {};
  return fail(ErrorCode::usage, kRename, name, "it cannot be a name",
              names_files ? "give up to 80 characters without '/', not beginning with '.'; products are named after it"
                          : "give up to 80 characters on one line");
}

// Publishes the registry with other files of one kind. `arrays` empty: without any of that kind.
Result<void> replace_entry(tile::Store::DerivedWriter& writer, std::vector<tile::DerivedEntry>& registry,
                           const tile::ArraySet& arrays, const std::string& name, const std::string& content) {
  KeyBuilder key(arrays.kind, 1);
  RAYFIELD_ASSIGN(tile::DerivedEntry entry, writer.put({"", arrays.kind, name, key.add(content).hex()}, arrays));
  std::erase_if(registry, [&](const tile::DerivedEntry& e) { return e.kind == arrays.kind; });
  registry.push_back(std::move(entry));
  return {};
}

std::string content_of(const RowLayout& layout) {
  std::string content;
  for (const auto& [name, column] : layout_to_arrays(layout).columns) {
    content += name + " ";
    std::visit(
        [&content](const auto& values) {
          const auto bytes = std::as_bytes(std::span(values));
          content += sha256_hex(bytes) + "\n";
        },
        column);
  }
  return content;
}

std::optional<int> whole_number(const std::string& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// Rows by the numbers that they are shown with before anything is renamed, so that two numbers may be exchanged.
Result<void> rename_rows(const std::map<int, std::string>& renamed, RowLayout layout, StoredNames& names) {
  const RowLayout before = layout;
  for (const auto& [shown, text] : renamed) {
    const auto row = std::find_if(before.rows.begin(), before.rows.end(), [&, wanted = shown](const Row& r) {
      return r.shown_number() == wanted && r.identity.valid_to.empty();
    });
    if (row == before.rows.end())
      return fail(ErrorCode::usage, kRename, fmt::format("row {}", shown), "the block has no such row",
                  "see `rayfield registry`");
    StoredNames::OfRow& stored = names.rows[row->identity.uid];
    if (const std::optional<int> number = whole_number(text)) {
      if (*number < 1 || *number > 1000000)
        return fail(ErrorCode::usage, kRename, fmt::format("row {}", shown), text + " is no number of a row",
                    "give a number from 1 on");
      stored.number = *number;
    } else {
      RAYFIELD_CHECK(check_name(text, false));
      if (text.empty())
        return fail(ErrorCode::usage, kRename, fmt::format("row {}", shown), "no name given", "write --row 3=NAME");
      stored.name = text;
    }
  }
  apply_names(names, layout);
  std::set<int> numbers;
  std::set<std::string> texts;
  for (const Row& row : layout.rows) {
    if (!row.identity.valid_to.empty()) continue;
    if (!numbers.insert(row.shown_number()).second)
      return fail(ErrorCode::usage, kRename, fmt::format("row {}", row.shown_number()), "another row has this number",
                  "give a number that is free, or rename both rows at once");
    if (!row.name.empty() && !texts.insert(row.name).second)
      return fail(ErrorCode::usage, kRename, row.name, "another row has this name", "give every row a name of its own");
  }
  return {};
}

// Greatest distance of a surveyed row from a known one, ends included.
double departure(const Row& surveyed, const Row& known) {
  double most = std::max((surveyed.centreline.front() - known.centreline.front()).norm(),
                         (surveyed.centreline.back() - known.centreline.back()).norm());
  for (const Eigen::Vector2d& p : surveyed.centreline)
    most = std::max(most, std::abs(project_onto_line(known.centreline, p).across_m));
  return most;
}

// True where the survey says nothing of geometry that the registry does not know to 5 cm.
bool same_geometry(const RowLayout& survey, const RowLayout& known) {
  constexpr double kSame = 0.05;  // m
  const bool rows = std::all_of(survey.rows.begin(), survey.rows.end(), [&](const Row& row) {
    return std::any_of(known.rows.begin(), known.rows.end(),
                       [&](const Row& other) { return departure(row, other) <= kSame; });
  });
  return rows && std::all_of(survey.posts.begin(), survey.posts.end(), [&](const Post& post) {
           return std::any_of(known.posts.begin(), known.posts.end(),
                              [&](const Post& other) { return (post.position - other.position).norm() <= kSame; });
         });
}

Result<void> check_near_scans(const tile::Snapshot& snapshot, const RowLayout& survey, const std::string& source) {
  constexpr double kReach = 50;  // m; what a lidar sees from where the vehicle drove
  double nearest = std::numeric_limits<double>::infinity();
  for (const tile::ScanEntry& scan : snapshot.scans) {
    const Eigen::AlignedBox2d box(Eigen::Vector2d(scan.origin_bounds.min().head<2>()),
                                  Eigen::Vector2d(scan.origin_bounds.max().head<2>()));
    for (const Row& row : survey.rows)
      for (const Eigen::Vector2d& p : row.centreline) nearest = std::min(nearest, box.exteriorDistance(p));
  }
  if (snapshot.scans.empty() || nearest <= kReach) return {};
  return fail(ErrorCode::bad_input, kImport, source,
              fmt::format("its rows lie {:.1f} km away from the store's scans", nearest / 1000),
              "check the CRS of the file, and that it is of this block");
}

// A survey on its way into the registry.
struct Import {
  RowLayout survey;  ///< with identities
  StoredNames names;
  ImportReport report;
};

Result<Import> prepare(const tile::Store& store, const tile::Snapshot& snapshot, const SurveyedBlock& surveyed) {
  Import import;
  RAYFIELD_ASSIGN(import.survey, layout_of_survey(surveyed));
  RAYFIELD_CHECK(check_near_scans(snapshot, import.survey, surveyed.source));
  RAYFIELD_ASSIGN(const BlockLayout known, current_layout(store, snapshot));
  RAYFIELD_ASSIGN(import.names, read_stored_names(store, snapshot));
  // What the survey calls rows goes before what they were called: numbers and names are given anew.
  const RowLayout placed = import.survey;
  take_over_identities(known.layout, import.survey);
  for (std::size_t i = 0; i < placed.rows.size(); ++i) {
    import.report.rows_matched += import.survey.rows[i].identity.uid.empty() ? 0 : 1;
  }
  for (const Post& post : import.survey.posts) import.report.posts_matched += post.identity.uid.empty() ? 0 : 1;
  name_by_place(import.survey, store.config().crs);
  for (std::size_t i = 0; i < placed.rows.size(); ++i) {
    if (placed.rows[i].farm_number == 0 && placed.rows[i].name.empty()) continue;
    StoredNames::OfRow& stored = import.names.rows[import.survey.rows[i].identity.uid];
    if (placed.rows[i].farm_number > 0) stored.number = placed.rows[i].farm_number;
    if (!placed.rows[i].name.empty()) stored.name = placed.rows[i].name;
  }
  import.report.rows = import.survey.rows.size();
  import.report.posts = import.survey.posts.size();
  import.report.geometry_changed = !known.known || !same_geometry(import.survey, known.layout);
  return import;
}

// Nobody could distinguish two rows of one number or name.
Result<void> check_shown(const RowLayout& known, const Import& import, const std::string& source) {
  RowLayout shown = import.report.geometry_changed ? import.survey : known;
  apply_names(import.names, shown);
  std::set<int> numbers;
  for (const Row& row : shown.rows)
    if (row.identity.valid_to.empty() && !numbers.insert(row.shown_number()).second)
      return fail(ErrorCode::bad_input, kImport, source,
                  fmt::format("two rows of the block would have the number {}", row.shown_number()),
                  "give numbers for all rows, or see `rayfield registry` for those that are taken");
  return {};
}

}  // namespace

Result<BlockNames> read_names(const tile::Store& store, const tile::Snapshot& snapshot) {
  RAYFIELD_ASSIGN(StoredNames names, read_stored_names(store, snapshot));
  if (names.block.block.empty()) names.block.block = store.block_name();
  return names.block;
}

Result<BlockProducts> read_registry(const tile::Store& store, const tile::Snapshot& snapshot) {
  RAYFIELD_ASSIGN(const BlockLayout block, current_layout(store, snapshot));
  RAYFIELD_ASSIGN(const BlockNames names, read_names(store, snapshot));
  const GroundModel unknown_ground(store.config().tile_size_m);
  BlockProducts products =
      layout_products(block.layout, names.block, store.config().crs, unknown_ground, kOutlineHalfWidth);
  products.farm = names.farm, products.variety = names.variety;
  return products;
}

Result<void> rename(tile::Store& store, const Renaming& renaming, const std::string& command) {
  RAYFIELD_ASSIGN(tile::Store::DerivedWriter writer, store.write_derived());
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(StoredNames names, read_stored_names(store, snapshot));
  if (renaming.block) {
    RAYFIELD_CHECK(check_name(*renaming.block, true));
    names.block.block = *renaming.block;
  }
  for (const auto& [text, member] :
       {std::pair{&renaming.farm, &BlockNames::farm}, std::pair{&renaming.variety, &BlockNames::variety}}) {
    if (!*text) continue;
    RAYFIELD_CHECK(check_name(**text, false));
    names.block.*member = **text;
  }
  RAYFIELD_ASSIGN(const BlockLayout block, current_layout(store, snapshot));
  RAYFIELD_CHECK(rename_rows(renaming.rows, block.layout, names));
  const tile::ArraySet arrays = names_to_arrays(names);
  std::vector<tile::DerivedEntry> registry = snapshot.registry;
  RAYFIELD_CHECK(replace_entry(writer, registry, arrays, kNamesName, arrays.attributes));
  RAYFIELD_CHECK(writer.set("", std::move(registry)));
  RAYFIELD_CHECK(writer.commit(command));
  return {};
}

Result<void> check_survey(const SurveyedBlock& survey) {
  RAYFIELD_CHECK(layout_of_survey(survey));
  return {};
}

Result<ImportReport> preview_reference(const tile::Store& store, const SurveyedBlock& survey) {
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const BlockLayout known, current_layout(store, snapshot));
  RAYFIELD_ASSIGN(const Import import, prepare(store, snapshot, survey));
  RAYFIELD_CHECK(check_shown(known.layout, import, survey.source));
  return import.report;
}

Result<ImportReport> import_reference(tile::Store& store, const SurveyedBlock& survey, const std::string& command) {
  RAYFIELD_ASSIGN(tile::Store::DerivedWriter writer, store.write_derived());
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const BlockLayout known, current_layout(store, snapshot));
  RAYFIELD_ASSIGN(const Import import, prepare(store, snapshot, survey));
  RAYFIELD_CHECK(check_shown(known.layout, import, survey.source));
  std::vector<tile::DerivedEntry> registry = snapshot.registry;
  if (import.report.geometry_changed)
    RAYFIELD_CHECK(replace_entry(writer, registry, layout_to_arrays(import.survey, kSurveyKind), kSurveyName,
                                 content_of(import.survey)));
  const tile::ArraySet names = names_to_arrays(import.names);
  RAYFIELD_CHECK(replace_entry(writer, registry, names, kNamesName, names.attributes));
  RAYFIELD_CHECK(writer.set("", std::move(registry)));
  RAYFIELD_CHECK(writer.commit(command));
  return import.report;
}

}  // namespace rayfield::density
