#include "tests/fault/damage_campaign.h"

#include <gmock/gmock.h>

#include "tests/fault/reseal.h"
#include "tests/libtile/processed_store.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::IsEmpty;

class DamageOf : public ProcessedStore {
 protected:
  fs::path spare() const { return folder_.path() / "spare"; }
};

TEST_F(DamageOf, EveryKindOfFileIsNoticedAndNothingElse) {
  const auto before = contents(store_.folder());
  const DamageCampaign campaign(store_.folder(), spare());
  const DamageTally tally = campaign.run(1000, 1, [](const std::string&) {});
  EXPECT_THAT(tally.findings, IsEmpty());
  for (const char* kind : {"rays", "ground", "snapshots", "store.json", "lock"})
    EXPECT_GT(tally.damages.at(kind), 20U) << kind;
  EXPECT_EQ(contents(store_.folder()), before);
}

// What is damaged and was not by the campaign itself must not pass.
TEST_F(DamageOf, WhatIsNotPutBackIsAFinding) {
  const DamageCampaign campaign(store_.folder(), spare());
  flip_bit(store_.folder() / "snapshots" / "00000001.json", 100);
  EXPECT_FALSE(campaign.run(1, 1, [](const std::string&) {}).findings.empty());
}

// Nor what is damaged and whole at the same time, as for a reader that looks at nothing: bytes that agree again.
TEST_F(DamageOf, AFileThatIsReadThoughItIsToldAsDamagedIsAFinding) {
  const std::string path = store_.latest()->scans.at(0).derived.at(0).file.path;
  const std::string whole = file_text(store_.folder() / path);
  const DamageCampaign campaign(store_.folder(), spare());
  const DamageTally tally = campaign.run(1, 1, [&](const std::string& what) {
    if (what.starts_with(path)) write_text(store_.folder() / path, whole);
  });
  EXPECT_FALSE(tally.findings.empty());
}

TEST_F(DamageOf, SealedAnewItIsAnErrorOrAStoreThatIsWhole) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const fs::path copy = folder_.path() / "copy";
    fs::remove_all(copy);
    fs::copy(store_.folder(), copy, fs::copy_options::recursive);
    std::mt19937_64 random(seed);
    const std::string what = reseal_changed(copy, random);
    EXPECT_NE(contents(copy), contents(store_.folder())) << what;
    const auto store = Store::open(copy);
    ASSERT_TRUE(store) << what;
    const auto latest = store->latest();
    if (!latest) continue;  // refused, with the code that it has
    for (const ScanEntry& scan : latest->scans) {
      for (const DerivedEntry& derived : scan.derived) {
        const auto arrays = store->read_derived(derived);
        EXPECT_TRUE(arrays || arrays.error().code == ErrorCode::damaged) << what;
      }
    }
  }
}

}  // namespace
}  // namespace rayfield::tile::testing
