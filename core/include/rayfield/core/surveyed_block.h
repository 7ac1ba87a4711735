#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

/// Rows and posts as somebody surveyed them: read by formats, taken into the block's registry by libdensity.
namespace rayfield {

/// A row as surveyed: its line, and what the farm calls it. Map coordinates, m.
struct SurveyedRow {
  std::optional<int> number;
  std::string name;
  std::vector<Eigen::Vector2d> line;
};

/// A post as surveyed, with the row that the survey assigns it to.
struct SurveyedPost {
  std::optional<int> row_number;
  std::string row_name;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  std::optional<double> height_m, diameter_m;
};

/// Rows, posts, or both.
struct SurveyedBlock {
  std::string source;  ///< the file's name, for messages
  std::vector<SurveyedRow> rows;
  std::vector<SurveyedPost> posts;
};

}  // namespace rayfield
