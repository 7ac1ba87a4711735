#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rayfield/core/option_fields.h"

namespace rayfield {
namespace option_fields {

// Counts the members that a struct names, a group as one.
struct Counter {
  std::size_t count = 0;
  void number(std::string_view, double, const OptionRange&, std::string_view) { ++count; }
  void integer(std::string_view, int, const OptionRange&, std::string_view) { ++count; }
  void optional_number(std::string_view, const std::optional<double>&, const OptionRange&, std::string_view) {
    ++count;
  }
  void numbers(std::string_view, const std::vector<double>&, const OptionRange&, std::size_t, std::string_view) {
    ++count;
  }
  void flag(std::string_view, bool, std::string_view) { ++count; }
  void text(std::string_view, const std::string&, std::string_view) { ++count; }
  template <class E, std::size_t N>
  void choice(std::string_view, const E&, const OptionChoices<E, N>&, std::string_view) {
    ++count;
  }
  template <class Options>
  void group(std::string_view, const Options&) {
    ++count;
  }
};

// Stands for a member of any type in the braces of an aggregate.
struct AnyMember {
  template <class T>
  operator T() const;
};

template <class T, class... Members>
constexpr std::size_t aggregate_size_from() {
  if constexpr (requires { T{Members{}..., AnyMember{}}; })
    return aggregate_size_from<T, Members..., AnyMember>();
  else
    return sizeof...(Members);
}

}  // namespace option_fields

/// Fields that a struct names in visit_fields(), and the members it has: equal, or one was left out.
template <class Options>
std::size_t option_count() {
  option_fields::Counter counter;
  const Options options{};
  Options::visit_fields(options, counter);
  return counter.count;
}
template <class Aggregate>
constexpr std::size_t aggregate_size() {
  return option_fields::aggregate_size_from<Aggregate>();
}

}  // namespace rayfield
