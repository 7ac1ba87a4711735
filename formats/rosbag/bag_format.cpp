#include "formats/rosbag/bag_format.h"

namespace rayfield::formats {
namespace {

struct Field {
  std::string_view name;
  std::span<const std::byte> value;
};

/// The next "name=value" of a header; nothing where its length is wrong or the '=' is missing.
std::optional<Field> next_field(ByteCursor& cursor) {
  const std::span<const std::byte> bytes = cursor.take_counted();
  if (cursor.failed() || bytes.empty()) return std::nullopt;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0) return std::nullopt;
  return Field{text.substr(0, equals), bytes.subspan(equals + 1)};
}

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

template <class T>
bool take_number(const Field& field, std::optional<T>& out) {
  if (field.value.size() != sizeof(T)) return false;
  out = load<T>(field.value.data());
  return true;
}

/// Stores a field that rayfield knows; false where its size is wrong.
bool take_field(const Field& field, BagHeader& header) {
  if (field.name == "op") {
    std::optional<std::uint8_t> op;
    if (!take_number(field, op)) return false;
    header.op = static_cast<BagOp>(*op);
  } else if (field.name == "conn") {
    return take_number(field, header.conn);
  } else if (field.name == "size") {
    return take_number(field, header.size);
  } else if (field.name == "index_pos") {
    return take_number(field, header.index_pos);
  } else if (field.name == "time") {
    if (field.value.size() != 8) return false;
    header.time_ns = std::int64_t{load<std::uint32_t>(field.value.data())} * 1'000'000'000 +
                     std::int64_t{load<std::uint32_t>(field.value.data() + 4)};
  } else if (field.name == "compression") {
    header.compression = as_text(field.value);
  } else if (field.name == "topic") {
    header.topic = as_text(field.value);
  } else if (field.name == "encryptor") {
    header.encryptor = as_text(field.value);
  }
  return true;
}

}  // namespace

std::optional<BagHeader> parse_bag_header(std::span<const std::byte> fields) {
  BagHeader header;
  ByteCursor cursor(fields);
  while (cursor.remaining() > 0) {
    const std::optional<Field> field = next_field(cursor);
    if (!field || !take_field(*field, header)) return std::nullopt;
  }
  if (!header.op) return std::nullopt;
  return header;
}

std::optional<BagConnection> parse_bag_connection(const BagHeader& header, std::span<const std::byte> data) {
  if (!header.conn) return std::nullopt;
  BagConnection connection;
  connection.id = *header.conn;
  connection.topic = header.topic;
  ByteCursor cursor(data);
  while (cursor.remaining() > 0) {
    const std::optional<Field> field = next_field(cursor);
    if (!field) return std::nullopt;
    if (field->name == "type") connection.type = as_text(field->value);
    if (field->name == "md5sum") connection.md5sum = as_text(field->value);
    if (field->name == "message_definition") connection.definition = as_text(field->value);
  }
  if (connection.topic.empty() || connection.type.empty()) return std::nullopt;
  return connection;
}

}  // namespace rayfield::formats
