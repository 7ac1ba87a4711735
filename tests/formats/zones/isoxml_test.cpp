#include "rayfield/formats/isoxml.h"

#include <cpl_minixml.h>
#include <cpl_vsi.h>
#include <gtest/gtest.h>
#include <ogr_geometry.h>

#include <cmath>
#include <map>
#include <memory>

#include "rayfield/formats/rates_file.h"
#include "tests/formats/gdal_dataset.h"
#include "tests/formats/products_support.h"
#include "tests/formats/zones/zone_support.h"

namespace rayfield::formats {
namespace {

using testing::drawn_map;
using testing::message;
using testing::read_file;
using testing::TemporaryFolder;

// The task in an archive.
struct XmlCloser {
  void operator()(CPLXMLNode* node) const { CPLDestroyXMLNode(node); }
};
using Xml = std::unique_ptr<CPLXMLNode, XmlCloser>;
Xml task_of(const std::string& archive) {
  return Xml(CPLParseXMLFile(("/vsizip/" + archive + "/TASKDATA/TASKDATA.XML").c_str()));
}

std::vector<CPLXMLNode*> children(CPLXMLNode* node, const std::string& name) {
  std::vector<CPLXMLNode*> all;
  for (CPLXMLNode* child = node->psChild; child != nullptr; child = child->psNext)
    if (child->eType == CXT_Element && name == child->pszValue) all.push_back(child);
  return all;
}
std::string attribute(CPLXMLNode* node, const char* name) { return CPLGetXMLValue(node, name, ""); }

OGRPolygon polygon_of(CPLXMLNode* node) {
  OGRPolygon polygon;
  for (CPLXMLNode* line : children(node, "LSG")) {
    OGRLinearRing ring;
    for (CPLXMLNode* point : children(line, "PNT"))
      ring.addPoint(std::stod(attribute(point, "D")), std::stod(attribute(point, "C")));
    EXPECT_TRUE(ring.get_IsClosed());
    EXPECT_EQ(attribute(line, "A"), polygon.IsEmpty() ? "1" : "2") << "the first ring is the exterior one";
    polygon.addRing(&ring);
  }
  return polygon;
}

TEST(IsoXml, EveryPolygonIsATreatmentZoneWithItsSetpoint) {
  const TemporaryFolder folder;
  ZoneMap map = drawn_map(60);
  map.farm = "<img onerror=alert(1)>", map.block = "Böll & \"Söhne\", Nord";
  const Prescription rates{"Kupfer", "l/ha", {150, 225.5, 300}};
  const auto written = write_isoxml(map, rates, folder / "t.zip");
  ASSERT_TRUE(written) << message(written);
  const Xml xml = task_of(folder / "t.zip");
  ASSERT_NE(xml, nullptr);
  CPLXMLNode* root = CPLGetXMLNode(xml.get(), "=ISO11783_TaskData");
  ASSERT_NE(root, nullptr);
  EXPECT_EQ(attribute(root, "VersionMajor"), "3");
  EXPECT_EQ(attribute(children(root, "FRM").at(0), "B"), map.farm);
  CPLXMLNode* field = children(root, "PFD").at(0);
  EXPECT_EQ(attribute(field, "C"), map.block);
  EXPECT_EQ(attribute(field, "D"), std::to_string(std::llround(map.area_m2)));
  const OGRPolygon boundary = polygon_of(children(field, "PLN").at(0));
  CPLXMLNode* task = children(root, "TSK").at(0);
  EXPECT_EQ(attribute(task, "E"), attribute(field, "A"));
  std::map<std::string, std::string> expected;  // 1 l/ha is 100 mm³/m², in steps of 0.01 mm³/m²
  for (const ManagementZone& zone : map.zones)
    expected["zone " + std::to_string(zone.zone)] =
        std::to_string(std::llround(rates.rates[static_cast<std::size_t>(zone.zone - 1)] * 1e4));
  expected["outside"] = "0";
  double area = 0;
  std::map<std::string, int> codes;
  for (CPLXMLNode* zone : children(task, "TZN")) {
    EXPECT_EQ(++codes[attribute(zone, "A")], 1) << "codes are unique";
    CPLXMLNode* setpoint = children(zone, "PDV").at(0);
    EXPECT_EQ(attribute(setpoint, "A"), "0001");
    EXPECT_EQ(attribute(setpoint, "B"), expected.at(attribute(zone, "B")));
    EXPECT_EQ(attribute(setpoint, "C"), attribute(children(root, "PDT").at(0), "A"));
    if (attribute(zone, "A") == "0") continue;
    ASSERT_EQ(children(zone, "PLN").size(), 1U);
    area += polygon_of(children(zone, "PLN").at(0)).get_Area();
  }
  EXPECT_NEAR(area, boundary.get_Area(), 1e-3 * boundary.get_Area());
  std::size_t parts = 0;
  for (const ManagementZone& zone : map.zones) parts += zone.parts.size();
  EXPECT_EQ(codes.size(), parts + 1);
  // What terminals show: steps · scale.
  CPLXMLNode* shown = children(root, "VPN").at(0);
  EXPECT_NEAR(225.5e4 * std::stod(attribute(shown, "C")), 225.5, 1e-6);
  EXPECT_EQ(attribute(shown, "E"), "l/ha");
}

TEST(IsoXml, UnitsHaveTheirDataDictionaryEntryAndSteps) {
  const TemporaryFolder folder;
  const ZoneMap map = drawn_map(1e9);  // one zone
  struct Case {
    const char *unit, *ddi;
    double rate;
    long long steps;
  };
  // ISO 11783-11: 1 in 0.01 mm³/m², 6 in 1 mg/m², 11 in 0.001 /m². 20 gal/ac are 187.08 l/ha, 100 lb/ac 112.085 kg/ha.
  const Case cases[] = {{"l/ha", "0001", 200, 2000000},  {"ml/m2", "0001", 20, 2000000},
                        {"m3/ha", "0001", 0.2, 2000000}, {"gal/ac", "0001", 20, 1870791},
                        {"kg/ha", "0006", 40, 4000},     {"g/m2", "0006", 4, 4000},
                        {"t/ha", "0006", 0.04, 4000},    {"lb/ac", "0006", 100, 11209},
                        {"1/ha", "000B", 5000, 500},     {"1/m2", "000B", 0.5, 500}};
  EXPECT_EQ(std::size(cases), rate_units().size());
  for (const Case& c : cases) {
    Prescription rates{"x", c.unit, {c.rate, c.rate, c.rate}};
    ASSERT_TRUE(write_isoxml(map, rates, folder / "t.zip")) << c.unit;
    const Xml xml = task_of(folder / "t.zip");
    CPLXMLNode* task = CPLGetXMLNode(xml.get(), "=ISO11783_TaskData.TSK");
    CPLXMLNode* setpoint = children(children(task, "TZN").at(1), "PDV").at(0);
    EXPECT_EQ(attribute(setpoint, "A"), c.ddi) << c.unit;
    EXPECT_EQ(attribute(setpoint, "B"), std::to_string(c.steps)) << c.unit;
  }
}

TEST(IsoXml, NamesAreCutTo32CharactersAndNotInsideOfOne) {
  const TemporaryFolder folder;
  ZoneMap map = drawn_map(1e9);
  map.block = std::string(30, 'x') + "äöüß";
  ASSERT_TRUE(write_isoxml(map, {"p", "kg/ha", {1, 1, 1}}, folder / "t.zip"));
  const Xml xml = task_of(folder / "t.zip");
  EXPECT_EQ(attribute(CPLGetXMLNode(xml.get(), "=ISO11783_TaskData.PFD"), "C"), std::string(30, 'x') + "äö");
  EXPECT_EQ(CPLGetXMLNode(xml.get(), "=ISO11783_TaskData.FRM"), nullptr) << "a block without a farm";
}

TEST(IsoXml, EqualInputGivesEqualBytes) {
  const TemporaryFolder folder;
  const ZoneMap map = drawn_map(60);
  const Prescription rates{"x", "kg/ha", {1, 2, 3}};
  ASSERT_TRUE(write_isoxml(map, rates, folder / "a.zip"));
  ASSERT_TRUE(write_isoxml(map, rates, folder / "b.zip"));
  EXPECT_EQ(read_file(folder / "a.zip"), read_file(folder / "b.zip"));
}

}  // namespace
}  // namespace rayfield::formats
