#include "cli/console/suggestion.h"

#include <gtest/gtest.h>

namespace rayfield::cli {
namespace {

const std::vector<std::string> kWords = {"process", "export", "report", "remove", "repair", "gc", "threads", "set"};

TEST(Suggestion, AWordIsKnownAgainWithAThirdOfItsLettersWrong) {
  EXPECT_EQ(similar_word("proces", kWords), "process");      // one left out
  EXPECT_EQ(similar_word("proecss", kWords), "process");     // two swapped
  EXPECT_EQ(similar_word("thread", kWords), "threads");      // one left out
  EXPECT_EQ(similar_word("exxport", kWords), "export");      // one too many
  EXPECT_EQ(similar_word("Export", kWords), "export");       // case is no mistake
  EXPECT_EQ(similar_word("cg", kWords), "gc");               // one mistake is allowed in any word
  EXPECT_EQ(similar_word("prxxxss", kWords), std::nullopt);  // three of seven
  EXPECT_EQ(similar_word("frobnicate", kWords), std::nullopt);
}

TEST(Suggestion, TheBeginningOfOneWordAloneStandsForIt) {
  EXPECT_EQ(similar_word("proc", kWords), "process");
  EXPECT_EQ(similar_word("re", kWords), std::nullopt) << "three words begin so";
  EXPECT_EQ(similar_word("", kWords), std::nullopt);
}

TEST(Suggestion, UnderscoresAreDashes) {
  EXPECT_EQ(similar_word("voxel_size", {"voxel-size", "leaf-area"}), "voxel-size");
}

TEST(Suggestion, WithoutASimilarWordOnlyTheHelpIsNamed) {
  EXPECT_EQ(suggestion("thread", kWords, "--", "`rayfield --help`"), "did you mean --threads? see `rayfield --help`");
  EXPECT_EQ(suggestion("zzzzz", kWords, "--", "`rayfield --help`"), "see `rayfield --help`");
}

}  // namespace
}  // namespace rayfield::cli
