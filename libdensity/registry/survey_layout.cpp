#include "libdensity/registry/survey_layout.h"

#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "libdensity/layout/polyline.h"
#include "libdensity/layout/row_order.h"

namespace rayfield::density {
namespace {

constexpr const char* kWhat = "cannot use the reference";
constexpr double kStep = 0.5;           // m between the vertices of a centreline, as of found rows
constexpr double kShortestRow = 2;      // m
constexpr double kNearRow = 1.0;        // m; a post further from its row's line is a mistake
constexpr double kSameRow = 0.5;        // m; rows closer to each other are the same
constexpr double kDefaultHeight = 1.8;  // m

std::string label(const std::optional<int>& number, const std::string& name) {
  if (number) return fmt::format("row {}", *number);
  return name.empty() ? "a row without number or name" : "row '" + name + "'";
}

tl::unexpected<Error> refused(const SurveyedBlock& survey, const std::string& why, const std::string& next) {
  return fail(ErrorCode::bad_input, kWhat, survey.source, why, next);
}

// Posts of one row in their order along it: along the direction in which they spread most.
std::vector<Eigen::Vector2d> line_through(const std::vector<Eigen::Vector2d>& posts) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : posts) mean += p / static_cast<double>(posts.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& p : posts) spread += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(spread);
  const Eigen::Vector2d along = axes.eigenvectors().col(1);
  std::vector<Eigen::Vector2d> line = posts;
  std::sort(line.begin(), line.end(),
            [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.dot(along) < b.dot(along); });
  return line;
}

// Vertices further apart than 1 cm only: lines drawn by hand have double points.
std::vector<Eigen::Vector2d> without_doubles(const std::vector<Eigen::Vector2d>& line) {
  std::vector<Eigen::Vector2d> clean;
  for (const Eigen::Vector2d& p : line)
    if (clean.empty() || (p - clean.back()).norm() > 0.01) clean.push_back(p);
  return clean;
}

// A surveyed row on its way: what the survey says of it, and the posts that name it.
struct Draft {
  std::optional<int> number;
  std::string name;
  std::vector<Eigen::Vector2d> line;
  std::vector<const SurveyedPost*> posts;
};

Draft* find_draft(std::vector<Draft>& drafts, const SurveyedPost& post) {
  for (Draft& draft : drafts) {
    if (post.row_number && draft.number == post.row_number) return &draft;
    if (!post.row_number && !post.row_name.empty() && draft.name == post.row_name) return &draft;
  }
  return nullptr;
}

Draft* nearest_draft(std::vector<Draft>& drafts, const Eigen::Vector2d& p) {
  Draft* nearest = nullptr;
  double least = kNearRow;
  for (Draft& draft : drafts) {
    if (draft.line.size() < 2) continue;
    const LineProjection on_line = project_onto_line(draft.line, p);
    const double beyond = std::max({0.0, -on_line.chainage_m, on_line.chainage_m - polyline_length(draft.line)});
    const double distance = std::hypot(on_line.across_m, beyond);
    if (distance < least) least = distance, nearest = &draft;
  }
  return nearest;
}

// Lines first, then each post to its row; posts that name a row which has no line make one.
Result<std::vector<Draft>> collect(const SurveyedBlock& survey) {
  std::vector<Draft> drafts;
  for (const SurveyedRow& row : survey.rows) {
    Draft draft{row.number, row.name, without_doubles(row.line), {}};
    if (draft.line.size() < 2 || polyline_length(draft.line) < kShortestRow)
      return refused(survey, label(row.number, row.name) + " is a point, not a line",
                     fmt::format("give rows as lines of at least {} m, or their posts as points", kShortestRow));
    drafts.push_back(std::move(draft));
  }
  for (const SurveyedPost& post : survey.posts) {
    Draft* draft = find_draft(drafts, post);
    const bool named = post.row_number || !post.row_name.empty();
    if (draft == nullptr && named) {
      drafts.push_back({post.row_number, post.row_name, {}, {}});
      draft = &drafts.back();
    }
    if (draft == nullptr) draft = nearest_draft(drafts, post.position);
    if (draft == nullptr)
      return refused(survey,
                     fmt::format("the post at {:.2f} {:.2f} belongs to no row", post.position.x(), post.position.y()),
                     "give posts a column row_number or row_name, or add the rows' lines");
    draft->posts.push_back(&post);
  }
  return drafts;
}

Result<void> check_drafts(const SurveyedBlock& survey, const std::vector<Draft>& drafts) {
  if (survey.posts.size() == 1 && survey.rows.empty())
    return refused(survey, "it holds one post; a row takes at least two", "give the posts of all rows, or their lines");
  if (drafts.empty())
    return refused(survey, "it holds neither lines nor points", "give rows as lines or posts as points");
  std::set<int> numbers;
  std::set<std::string> names;
  for (const Draft& draft : drafts) {
    if (draft.line.empty() && draft.posts.size() < 2)
      return refused(survey, label(draft.number, draft.name) + " has one post; a row takes at least two, or a line",
                     "add the row's other posts, or leave it out");
    if (draft.number && (*draft.number < 1 || *draft.number > 1000000))
      return refused(survey, label(draft.number, draft.name) + " has no number from 1 on", "correct row_number");
    if (draft.number && !numbers.insert(*draft.number).second)
      return refused(survey, fmt::format("two rows have the number {}", *draft.number),
                     "give every row one line and a number of its own");
    if (!draft.name.empty() && !names.insert(draft.name).second)
      return refused(survey, "two rows have the name '" + draft.name + "'", "give every row a name of its own");
  }
  return {};
}

// Mistakes that geometry shows: a post far from the row that it names, two rows in one place.
Result<void> check_geometry(const SurveyedBlock& survey, const std::vector<Draft>& drafts) {
  for (const Draft& draft : drafts) {
    for (const SurveyedPost* post : draft.posts) {
      const LineProjection on_line = project_onto_line(draft.line, post->position);
      if (std::abs(on_line.across_m) <= kNearRow) continue;
      return refused(survey,
                     fmt::format("the post at {:.2f} {:.2f} stands {:.1f} m beside {}", post->position.x(),
                                 post->position.y(), std::abs(on_line.across_m), label(draft.number, draft.name)),
                     "correct the row that the post names");
    }
    for (const Draft& other : drafts) {
      if (&other == &draft) continue;
      const Eigen::Vector2d middle = point_at(draft.line, 0.5 * polyline_length(draft.line)).position;
      const LineProjection on_line = project_onto_line(other.line, middle);
      if (on_line.inside && std::abs(on_line.across_m) < kSameRow)
        return refused(survey,
                       fmt::format("{} and {} lie on each other", label(draft.number, draft.name),
                                   label(other.number, other.name)),
                       "give every row once, as one line");
    }
  }
  return {};
}

// Rows without a number get the lowest that are free, so that each has one that is shown.
void number_the_rest(RowLayout& layout) {
  std::set<int> taken;
  for (const Row& row : layout.rows) taken.insert(row.farm_number);
  if (taken.size() == 1 && *taken.begin() == 0) return;  // none is numbered: the block's own order stands
  int next = 1;
  for (Row& row : layout.rows) {
    if (row.farm_number > 0) continue;
    while (taken.count(next) > 0) ++next;
    row.farm_number = next;
    taken.insert(next);
  }
}

}  // namespace

Result<RowLayout> layout_of_survey(const SurveyedBlock& survey) {
  RAYFIELD_ASSIGN(std::vector<Draft> drafts, collect(survey));
  RAYFIELD_CHECK(check_drafts(survey, drafts));
  for (Draft& draft : drafts) {
    if (!draft.line.empty()) continue;
    std::vector<Eigen::Vector2d> posts;
    for (const SurveyedPost* post : draft.posts) posts.push_back(post->position);
    draft.line = without_doubles(line_through(posts));
    if (draft.line.size() < 2 || polyline_length(draft.line) < kShortestRow)
      return refused(survey, "the posts of " + label(draft.number, draft.name) + " stand in one place",
                     "check the coordinates of the posts");
  }
  RAYFIELD_CHECK(check_geometry(survey, drafts));

  RowLayout layout;
  for (std::size_t i = 0; i < drafts.size(); ++i) {
    Row row;
    row.centreline = resampled(drafts[i].line, kStep);
    row.farm_number = drafts[i].number.value_or(0), row.name = drafts[i].name;
    row.identity.source = "surveyed";
    row.identity.uid = std::to_string(i);  // until rows are in their order: which draft it was
    layout.rows.push_back(std::move(row));
  }
  number_rows(layout);
  number_the_rest(layout);
  for (Row& row : layout.rows) {
    const Draft& draft = drafts[static_cast<std::size_t>(std::stoul(row.identity.uid))];
    row.identity.uid.clear();
    std::vector<Post> posts;
    for (const SurveyedPost* surveyed : draft.posts) {
      const LineProjection on_line = project_onto_line(row.centreline, surveyed->position);
      Post post;
      post.row = row.number, post.position = surveyed->position;
      post.chainage_m = on_line.chainage_m, post.across_m = on_line.across_m;
      post.height_m = surveyed->height_m.value_or(kDefaultHeight);
      if (surveyed->diameter_m) post.radius_m = *surveyed->diameter_m / 2;
      post.detected = false;
      post.identity.source = "surveyed";
      posts.push_back(std::move(post));
    }
    std::sort(posts.begin(), posts.end(), [](const Post& a, const Post& b) { return a.chainage_m < b.chainage_m; });
    layout.posts.insert(layout.posts.end(), posts.begin(), posts.end());
  }
  return layout;
}

}  // namespace rayfield::density
