#include "cli/experiments/report_text.h"

#include <gtest/gtest.h>

namespace rayfield::cli {
namespace {

TEST(ReportText, SharesArePerCentWithTheirSignAndNoughtHasNone) {
  EXPECT_EQ(percent(0.0312), "+3.1");
  EXPECT_EQ(percent(-0.685), "−68.5");
  EXPECT_EQ(percent(-0.0001), "0.0");
  EXPECT_EQ(percent(0.00123, 2), "+0.12");
  EXPECT_EQ(percent(experiments::Mean{-0.05, 0.002}), "−5.0 ± 0.2");
}

TEST(ReportText, TablesAreMarkdownWithColumnsOfTheirWidestCellInCharactersNotBytes) {
  TextTable table({"λ", "error"});
  table.add({"0.1", "−5"});
  EXPECT_EQ(table.text(),
            "| λ   | error |\n"
            "|-----|-------|\n"
            "| 0.1 | −5    |\n");
}

TEST(ReportText, NotesAreLinesOfAList) { EXPECT_EQ(notes_text({"a", "b"}), "- a\n- b\n"); }

}  // namespace
}  // namespace rayfield::cli
