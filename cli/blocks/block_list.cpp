#include "cli/blocks/block_list.h"

#include <fmt/core.h>

#include <toml++/toml.h>

#include "rayfield/core/date.h"
#include "rayfield/core/text_file.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWhat = "bad list of blocks";

// A node of the list with where it stands, for messages.
struct Place {
  const std::string& file;
  tl::unexpected<Error> bad(const toml::node& node, std::string_view why, std::string_view next = {}) const {
    return fail(ErrorCode::usage, kWhat, fmt::format("{}:{}", file, node.source().begin.line), why, next);
  }
};

Result<std::string> text_of(const toml::node& node, std::string_view key, const Place& place) {
  if (const auto text = node.value<std::string>(); text && node.is_string() && !text->empty()) return *text;
  return place.bad(node, fmt::format("'{}' must be a text", key));
}

Result<std::string> date_of(const toml::node& node, const Place& place) {
  if (const auto date = node.value<toml::date>(); date && node.is_date())
    return fmt::format("{:04}-{:02}-{:02}", date->year, static_cast<int>(date->month), static_cast<int>(date->day));
  RAYFIELD_ASSIGN(const std::string text, text_of(node, "date", place));
  const auto date = parse_date(text);
  if (!date) return place.bad(node, fmt::format("'{}': {}", text, date.error().why), date.error().next);
  return *date;
}

Result<std::vector<std::string>> texts_of(const toml::node& node, std::string_view key, const Place& place) {
  std::vector<std::string> texts;
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty()) return place.bad(node, fmt::format("'{}' must be a list of texts", key));
  for (const toml::node& item : *array) {
    RAYFIELD_ASSIGN(std::string text, text_of(item, key, place));
    texts.push_back(std::move(text));
  }
  return texts;
}

Result<BlockUpdate> parse_block(const toml::table& table, const fs::path& folder, const Place& place) {
  BlockUpdate block;
  for (const auto& [name, node] : table) {
    const std::string key(name.str());
    if (key == "inputs") {
      RAYFIELD_ASSIGN(const std::vector<std::string> files, texts_of(node, key, place));
      for (const std::string& file : files) block.inputs.files.push_back(folder / file);
    } else if (key == "set") {
      RAYFIELD_ASSIGN(block.settings, texts_of(node, key, place));
    } else if (key == "date") {
      RAYFIELD_ASSIGN(block.date, date_of(node, place));
    } else if (key == "store" || key == "rig" || key == "trajectory" || key == "name" || key == "output" ||
               key == "crs") {
      RAYFIELD_ASSIGN(const std::string text, text_of(node, key, place));
      if (key == "store") block.store = folder / text;
      if (key == "rig") block.inputs.rig_file = (folder / text).string();
      if (key == "trajectory") block.inputs.trajectory_file = (folder / text).string();
      if (key == "output") block.output = folder / text;
      if (key == "name") block.name = text;
      if (key == "crs") block.crs = text;
    } else {
      return place.bad(node, fmt::format("unknown key '{}'", key),
                       "a block has store, inputs, rig, trajectory, date, name, output, crs, set");
    }
  }
  for (const auto& [key, missing] :
       {std::pair{"store", block.store.empty()}, std::pair{"inputs", block.inputs.files.empty()},
        std::pair{"date", block.date.empty()}})
    if (missing) return place.bad(table, fmt::format("a block without '{}'", key));
  return block;
}

}  // namespace

Result<std::vector<BlockUpdate>> parse_block_list(const std::string& text, const std::string& name) {
  RAYFIELD_CHECK(check_toml_text(text, kWhat, name));
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& e) {
    return fail(ErrorCode::usage, kWhat, fmt::format("{}:{}", name, e.source().begin.line), e.description());
  }
  const Place place{name};
  for (const auto& [key, node] : root)
    if (key.str() != "block" || !node.is_array_of_tables())
      return place.bad(node, fmt::format("unknown key '{}'", std::string(key.str())), "every block begins [[block]]");
  std::vector<BlockUpdate> blocks;
  if (const toml::array* array = root["block"].as_array()) {
    for (const toml::node& node : *array) {
      RAYFIELD_ASSIGN(BlockUpdate block, parse_block(*node.as_table(), fs::path(name).parent_path(), place));
      blocks.push_back(std::move(block));
    }
  }
  if (blocks.empty()) return fail(ErrorCode::usage, kWhat, name, "it holds no block", "begin each with [[block]]");
  return blocks;
}

}  // namespace rayfield::cli
