#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "cli/blocks/reference.h"
#include "cli/commands/commands.h"
#include "cli/console/output_paths.h"
#include "rayfield/density/registry.h"
#include "rayfield/formats/registry_file.h"

namespace rayfield::cli {
namespace {

using nlohmann::ordered_json;

struct RegistryArguments {
  std::string action_or_store;
  std::vector<std::string> rest;  // STORE after an action, then the file of an import
  std::string output;
  std::optional<std::string> block, farm, variety;
  std::vector<std::string> rows;
};

constexpr const char* kActions[] = {"list", "rename", "import", "export"};

// `registry STORE` lists; `registry ACTION STORE` and `registry STORE ACTION` do the action.
struct Request {
  std::string action = "list", store, file;
};

// What the arguments ask for. Options that belong to another action are refused.
Result<Request> request_of(const RegistryArguments& arguments) {
  std::vector<std::string> words{arguments.action_or_store};
  words.insert(words.end(), arguments.rest.begin(), arguments.rest.end());
  Request request;
  const auto is_action = [](const std::string& word) {
    return std::find(std::begin(kActions), std::end(kActions), word) != std::end(kActions);
  };
  // A folder that is called like an action is written ./list.
  for (std::size_t i = 0; i < std::min<std::size_t>(2, words.size()); ++i) {
    if (!is_action(words[i])) continue;
    request.action = words[i];
    words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
    break;
  }
  const std::size_t expected = request.action == "import" ? 2 : 1;
  if (words.size() != expected)
    return fail(ErrorCode::usage, "wrong usage", "rayfield registry",
                words.size() < expected ? "a STORE, or the file to import, is missing" : "there are too many words",
                "see `rayfield registry --help`");
  request.store = words[0];
  if (expected == 2) request.file = words[1];
  const bool renames = arguments.block || arguments.farm || arguments.variety || !arguments.rows.empty();
  if (renames != (request.action == "rename"))
    return fail(ErrorCode::usage, "wrong usage", "rayfield registry " + request.action,
                renames ? "names are given to `rename`" : "no new name was given", "see `rayfield registry --help`");
  if (arguments.output.empty() == (request.action == "export"))
    return fail(ErrorCode::usage, "wrong usage", "rayfield registry " + request.action,
                arguments.output.empty() ? "it takes the file to write" : "only `export` writes a file",
                "give -o FILE.gpkg, .geojson or .csv to `export`");
  return request;
}

ordered_json json_number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(); }
ordered_json json_date(const std::string& date) { return date.empty() ? ordered_json() : ordered_json(date); }

template <class Product>
void add_validity(ordered_json& json, const Product& product) {
  json["row_number"] = product.row_number, json["row_name"] = product.row_name;
  json["valid_from"] = json_date(product.valid_from), json["valid_to"] = json_date(product.valid_to);
  json["source"] = product.source;
}

// Rows, panels and posts with their names and dates, for --json.
ordered_json json_of(const BlockProducts& block, const std::string& store) {
  ordered_json json = {{"store", store},
                       {"block", block.block},
                       {"farm", block.farm},
                       {"variety", block.variety},
                       {"crs", block.crs},
                       {"rows", ordered_json::array()},
                       {"panels", ordered_json::array()},
                       {"posts", ordered_json::array()}};
  for (const RowProduct& row : block.rows) {
    ordered_json entry = {{"row_uid", row.row_uid}};
    add_validity(entry, row);
    entry["length_m"] = row.length_m;
    json["rows"].push_back(std::move(entry));
  }
  for (const PanelProduct& panel : block.panels) {
    ordered_json entry = {{"panel_uid", panel.panel_uid}, {"panel_number", panel.panel_number}};
    add_validity(entry, panel);
    entry["chainage_start_m"] = panel.chainage_start_m, entry["chainage_end_m"] = panel.chainage_end_m;
    json["panels"].push_back(std::move(entry));
  }
  for (const PostProduct& post : block.posts) {
    ordered_json entry = {{"post_uid", post.post_uid}};
    add_validity(entry, post);
    entry["chainage_m"] = post.chainage_m;
    entry["easting_m"] = post.position.x(), entry["northing_m"] = post.position.y();
    entry["height_m"] = json_number(post.height_m), entry["detected"] = post.detected;
    json["posts"].push_back(std::move(entry));
  }
  return json;
}

std::string validity_text(const std::string& from, const std::string& to) {
  std::string text;
  if (!from.empty()) text += ", from " + from;
  if (!to.empty()) text += ", gone since " + to;
  return text;
}

template <class Product>
std::size_t count_in(const std::vector<Product>& products, const RowProduct& row) {
  std::size_t count = 0;
  for (const Product& product : products) count += product.row_number == row.row_number ? 1 : 0;
  return count;
}

// One line per row, and one per post that has come or gone; the whole list is in --json and in exports.
std::string text_of(const BlockProducts& block) {
  std::string text = block.block;
  if (!block.farm.empty()) text += ", farm " + block.farm;
  if (!block.variety.empty()) text += ", variety " + block.variety;
  text += fmt::format(": {} rows, {} panels, {} posts\n", block.rows.size(), block.panels.size(), block.posts.size());
  if (block.rows.empty()) text += "  no rows yet: they are found by `rayfield process`, or imported\n";
  for (const RowProduct& row : block.rows)
    text +=
        fmt::format("  row {:>3}{}  {:.1f} m, {} panels, {} posts, {}{}  {}\n", row.row_number,
                    row.row_name.empty() ? "" : " \"" + row.row_name + "\"", row.length_m, count_in(block.panels, row),
                    count_in(block.posts, row), row.source, validity_text(row.valid_from, row.valid_to), row.row_uid);
  for (const PostProduct& post : block.posts)
    if (!post.valid_from.empty() || !post.valid_to.empty())
      text += fmt::format("  post of row {} at {:.2f} m{}  {}\n", post.row_number, post.chainage_m,
                          validity_text(post.valid_from, post.valid_to), post.post_uid);
  return text;
}

Result<Outcome> list(const tile::Store& store, const std::string& folder) {
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const BlockProducts block, density::read_registry(store, snapshot));
  return Outcome{json_of(block, folder), text_of(block)};
}

Result<density::Renaming> renaming_of(const RegistryArguments& arguments) {
  density::Renaming renaming{arguments.block, arguments.farm, arguments.variety, {}};
  for (const std::string& row : arguments.rows) {
    const std::size_t equals = row.find('=');
    int number = 0;
    const auto parsed = std::from_chars(row.data(), row.data() + std::min(equals, row.size()), number);
    if (equals == std::string::npos || parsed.ec != std::errc() || parsed.ptr != row.data() + equals)
      return fail(ErrorCode::usage, "wrong usage", "--row " + row, "it is not NUMBER=NAME",
                  "write --row 3=\"Row 12\" or --row 3=12");
    renaming.rows[number] = row.substr(equals + 1);
  }
  return renaming;
}

Result<Outcome> run_rename(tile::Store& store, const Request& request, const RegistryArguments& arguments,
                           const Context& context) {
  RAYFIELD_ASSIGN(const density::Renaming renaming, renaming_of(arguments));
  if (!context.options.dry_run) RAYFIELD_CHECK(density::rename(store, renaming, context.command_line));
  return list(store, request.store);
}

Result<Outcome> run_import(tile::Store& store, const Request& request, const Context& context) {
  RAYFIELD_ASSIGN(const density::ImportReport report,
                  take_reference(store, request.file, context.options.dry_run, context.command_line));
  Outcome outcome;
  outcome.data = {{"store", request.store},
                  {"file", request.file},
                  {"dry_run", context.options.dry_run},
                  {"rows", report.rows},
                  {"rows_matched", report.rows_matched},
                  {"posts", report.posts},
                  {"posts_matched", report.posts_matched},
                  {"geometry_changed", report.geometry_changed}};
  outcome.text = fmt::format(
      "{} {} rows ({} known) and {} posts ({} known) from {}\n{}\n", context.options.dry_run ? "Would take" : "Took",
      report.rows, report.rows_matched, report.posts, report.posts_matched, request.file,
      report.geometry_changed ? "They rule the layout from the next `rayfield process` on"
                              : "They stand where the registry has them; names and numbers are taken over");
  return outcome;
}

Result<Outcome> run_export(const tile::Store& store, const Request& request, const std::string& path,
                           const Context& context) {
  const std::vector<OutputPath> outputs{{"--output", "cannot write the registry", path}};
  RAYFIELD_CHECK(check_outputs(outputs, {}, context.options.overwrite));
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const BlockProducts block, density::read_registry(store, snapshot));
  if (block.rows.empty())
    return fail(ErrorCode::usage, "nothing to export", request.store, "the block has no rows yet",
                "run `rayfield process`, or import a reference");
  if (!context.options.dry_run) RAYFIELD_CHECK(formats::write_registry_file(block, path));
  Outcome outcome;
  outcome.data = {{"store", request.store},      {"file", path},
                  {"rows", block.rows.size()},   {"panels", block.panels.size()},
                  {"posts", block.posts.size()}, {"dry_run", context.options.dry_run}};
  outcome.text = path + "\n";
  return outcome;
}

Result<Outcome> run_registry(const RegistryArguments& arguments, const Context& context) {
  RAYFIELD_ASSIGN(const Request request, request_of(arguments));
  RAYFIELD_ASSIGN(tile::Store store, tile::Store::open(request.store));
  if (request.action == "rename") return run_rename(store, request, arguments, context);
  if (request.action == "import") return run_import(store, request, context);
  if (request.action == "export") return run_export(store, request, arguments.output, context);
  return list(store, request.store);
}

}  // namespace

void add_registry_command(Commands& commands) {
  const auto arguments = std::make_shared<RegistryArguments>();
  CLI::App* command = commands.add("registry", "Rows, panels and posts of a block, and what they are called",
                                   "rayfield registry rename myblock --farm \"Hill Farm\" --row 3=\"Row 12\"",
                                   [arguments](Context& context) { return run_registry(*arguments, context); });
  command
      ->add_option("ACTION", arguments->action_or_store,
                   "list (the default), rename, import or export; then STORE, and the FILE to import")
      ->required()
      ->type_name("list|rename|import|export");
  command->add_option("STORE", arguments->rest, "Folder of the store, and the file to import")->expected(0, 2);
  command->add_option("-o,--output", arguments->output, "File to export to: .gpkg, .geojson or .csv");
  command->add_option("--block", arguments->block, "New name of the block; products are named after it");
  command->add_option("--farm", arguments->farm, "Name of the farm");
  command->add_option("--variety", arguments->variety, "Variety that is grown");
  command
      ->add_option("--row", arguments->rows,
                   "NUMBER=NAME: the farm's name of a row, or its number if NAME is a whole number")
      ->allow_extra_args(false);
}

}  // namespace rayfield::cli
