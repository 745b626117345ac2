// The page claims nothing that its runs do not show.
#include "report/page.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace baton::test {
namespace {
namespace fs = std::filesystem;

FigureResult resultOf(const std::string& number, double measured, const std::string& failure = "") {
  FigureResult result;
  result.figure.number = number;
  result.figure.title = "title of " + number;
  result.figure.finding = "finding of " + number;
  result.checks = {
      {.what = "check of " + number, .unit = "m", .predicted = 1.0, .measured = measured, .tolerance = 0.1}};
  result.failure = failure;
  return result;
}

Erratum restingOn(const std::vector<std::string>& figures) {
  return {.where = "where", .printed = "printed", .right = "right", .evidence = "evidence", .figures = figures};
}

std::size_t countOf(const std::string& word, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST(Page, SaysOfEachFigureAndErratumWhatItsRunsShow) {
  const fs::path file = fs::temp_directory_path() / ("baton-page-" + std::to_string(getpid()) + ".html");
  writePage(file, {resultOf("3", 1.05), resultOf("4", 1.2), resultOf("5", 1.0, "a run broke off")},
            {restingOn({"3"}), restingOn({"3", "4"}), restingOn({"5"}), restingOn({"3", "99"}), restingOn({})}, {});
  std::ifstream stream(file, std::ios::binary);
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  fs::remove(file);

  EXPECT_EQ(countOf("agrees with theory<", page), 2U) << "in the summary and where it is shown";
  EXPECT_EQ(countOf("differs from theory<", page), 2U);
  EXPECT_EQ(countOf("not completed<", page), 2U);
  EXPECT_EQ(countOf("finding of", page), 1U) << "of the one that agrees";
  EXPECT_NE(page.find("a run broke off"), std::string::npos);
  EXPECT_NE(page.find("check of 5"), std::string::npos) << "what was measured all the same";

  const std::string errata = page.substr(page.find("What the report has wrong"));
  EXPECT_EQ(countOf(">established<", errata), 1U);
  EXPECT_EQ(countOf(">not established<", errata), 2U);
  EXPECT_EQ(countOf("<td>not run", errata), 1U);
  EXPECT_EQ(countOf("<td>no figure", errata), 1U);
}

}  // namespace
}  // namespace baton::test
