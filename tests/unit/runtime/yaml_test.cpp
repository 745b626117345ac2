#include "runtime/yaml.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "bad_input.hpp"

namespace baton {
namespace {

using test::refusal;

constexpr double kPi = 3.14159265358979323846;

YamlNode parse(const std::string& text) { return YamlNode::parse("a.yaml", text); }

/// The value of `x: <scalar>`.
YamlNode scalar(const std::string& text) { return parse("x: " + text).map({"x"})["x"]; }

TEST(YamlNumber, ReadsDecimals) {
  EXPECT_EQ(scalar("0.0005").number(), 0.0005);
  EXPECT_EQ(scalar("-3").number(), -3.0);
  EXPECT_EQ(scalar("+3").number(), 3.0);
  EXPECT_EQ(scalar("1e-3").number(), 1e-3);
  EXPECT_EQ(scalar(".5").number(), 0.5);
}

TEST(YamlNumber, ReadsMultiplesOfPiAsTheProductDividedByTheDivisor) {
  EXPECT_EQ(scalar("pi").number(), kPi);
  EXPECT_EQ(scalar("-pi").number(), -kPi);
  EXPECT_EQ(scalar("+pi/2").number(), kPi / 2.0);
  EXPECT_EQ(scalar("-pi/6").number(), -kPi / 6.0);
  EXPECT_EQ(scalar("2*pi/3").number(), 2.0 * kPi / 3.0);
  EXPECT_EQ(scalar("-1.5*pi").number(), -1.5 * kPi);
  EXPECT_EQ(scalar("2 * pi / 3").number(), 2.0 * kPi / 3.0);
}

class NotANumber : public testing::TestWithParam<const char*> {};

TEST_P(NotANumber, IsRefusedWithFileLineAndWhatWasFound) {
  const std::string message = refusal([] { return scalar(GetParam()).number(); });
  EXPECT_EQ(message.rfind("a.yaml:1: x: expected a number, found ", 0), 0u) << message;
}

INSTANTIATE_TEST_SUITE_P(Scalars, NotANumber,
                         testing::Values("nan", ".nan", "NaN", "inf", "-inf", ".inf", "++1", "1e999", "heavy", "1 2",
                                         "1,5", "0x10", "--1", "+-1", "1/3", "3pi", "pi*2", "pi/0", "pi/-2", "-2*-pi",
                                         "pi/", "pipi", "2**pi", "nan*pi", "pi/inf", "'3'", "[1]", "{a: 1}", "", "~",
                                         "true", "+"));

TEST(YamlNumber, KeepsToItsRangeAndSaysTheUnit) {
  const NumberRange mass{0.0, 10.0, "kg"};
  EXPECT_EQ(scalar("0").number(mass), 0.0);
  EXPECT_EQ(scalar("10").number(mass), 10.0);
  EXPECT_EQ(refusal([&] { return scalar("-0.1").number(mass); }),
            "a.yaml:1: x: expected a number from 0 to 10 kg, found '-0.1'");
  EXPECT_EQ(refusal([&] { return scalar("10.1").number(mass); }),
            "a.yaml:1: x: expected a number from 0 to 10 kg, found '10.1'");
  const NumberRange positive{0.0, 10.0, "kg", true};
  EXPECT_EQ(refusal([&] { return scalar("0").number(positive); }),
            "a.yaml:1: x: expected a number above 0 and up to 10 kg, found '0'");
}

TEST(YamlNumber, WithACommaIsToldOfThePoint) {
  EXPECT_EQ(refusal([] { return scalar("0,5").number(); }),
            "a.yaml:1: x: expected a number, found '0,5'; the decimal sign is a point: 0.5");
}

TEST(YamlInteger, ReadsWholeNumbersInRangeOnly) {
  EXPECT_EQ(scalar("-4").integer(-4, 4), -4);
  EXPECT_EQ(scalar("+4").integer(-4, 4), 4);
  for (const char* bad : {"5", "1.0", "1e0", "one", "99999999999999999999", "'1'", ""}) {
    const std::string message = refusal([&] { return scalar(bad).integer(0, 4); });
    EXPECT_EQ(message.rfind("a.yaml:1: x: expected a whole number from 0 to 4, found ", 0), 0u) << message;
  }
}

TEST(YamlBoolean, IsTrueOrFalseAndNothingElse) {
  EXPECT_TRUE(scalar("true").boolean());
  EXPECT_FALSE(scalar("false").boolean());
  for (const char* bad : {"yes", "on", "1", "True", "'true'", ""}) {
    const std::string message = refusal([&] { return scalar(bad).boolean(); });
    EXPECT_EQ(message.rfind("a.yaml:1: x: expected true or false, found ", 0), 0u) << message;
  }
}

TEST(YamlText, MayBeQuotedAndLooksLikeAnything) {
  EXPECT_EQ(scalar("no").text(), "no");
  EXPECT_EQ(scalar("'1.0'").text(), "1.0");
  EXPECT_EQ(refusal([] { return scalar("abcdef").text(5); }),
            "a.yaml:1: x: expected text of at most 5 bytes, found 'abcdef'");
  EXPECT_EQ(refusal([] { return scalar("[a, b]").text(); }), "a.yaml:1: x: expected text, found a list of 2 values");
}

TEST(YamlName, HasUpTo31CharactersOfASmallSet) {
  EXPECT_EQ(scalar("arm_2-B").name(), "arm_2-B");
  EXPECT_EQ(scalar(std::string(31, 'a')).name().size(), 31u);
  for (const std::string& bad :
       {std::string("''"), std::string(32, 'a'), std::string("a b"), std::string("a/b"), std::string("../a"),
        std::string("-rf"), std::string("\xc3\xa4"), std::string("[a]")}) {
    const std::string message = refusal([&] { return scalar(bad).name(); });
    EXPECT_EQ(message.rfind("a.yaml:1: x: expected a name of 1 to 31 characters", 0), 0u) << message;
  }
}

TEST(YamlWord, IsOneOutOfTheChoices) {
  EXPECT_EQ(scalar("two").oneOf<int>({{"one", 1}, {"two", 2}}), 2);
  EXPECT_EQ(refusal([] {
              return scalar("three").oneOf<int>({{"one", 1}, {"two", 2}});
            }),
            "a.yaml:1: x: expected one of one, two, found 'three'");
}

TEST(YamlNumbers, HaveTheSizeAskedFor) {
  EXPECT_EQ(scalar("[1, pi, -2]").numbers(3), (std::vector<double>{1.0, kPi, -2.0}));
  EXPECT_EQ(scalar("[1, 2, 3]").vector3({}), Vector3(1.0, 2.0, 3.0));
  EXPECT_EQ(refusal([] { return scalar("[1, 2]").numbers(3, {}, "joint"); }),
            "a.yaml:1: x: expected a list of 3 numbers, one per joint, found a list of 2 values");
  EXPECT_EQ(refusal([] { return scalar("[0,5, 0,1]").numbers(2); }),
            "a.yaml:1: x: expected a list of 2 numbers whose decimal sign is a point, found a list of 4 values");
  EXPECT_EQ(refusal([] { return scalar("7").numbers(1); }), "a.yaml:1: x: expected a list of 1 number, found '7'");
  EXPECT_EQ(refusal([] { return parse("x:\n  - 1\n  - a\n").map({"x"})["x"].numbers(2); }),
            "a.yaml:3: x[1]: expected a number, found 'a'");
}

TEST(YamlList, SaysThePlaceOfEachItem) {
  const YamlNode node = parse("x:\n  - {y: 1}\n  - {z: 2}\n").map({"x"})["x"];
  const auto items = node.list(1, 2);
  EXPECT_EQ(items[0].map({"y"})["y"].number(), 1.0);
  EXPECT_EQ(refusal([&] { return items[1].map({"y"})["y"]; }).rfind("a.yaml:3: x[1]: unknown key 'z'", 0), 0u);
  EXPECT_EQ(refusal([&] { return node.list(3, 9); }),
            "a.yaml:1: x: expected a list of 3 to 9 values, found a list of 2 values");
  EXPECT_EQ(refusal([] { return scalar("").list(0, 9); }),
            "a.yaml:1: x: expected a list of 0 to 9 values ([] for none), found nothing");
}

TEST(YamlMap, RefusesUnknownKeysAndSuggestsTheNearest) {
  const std::string message = refusal([] { return parse("name: a\nstepp_s: 1\n").map({"name", "step_s", "mode"}); });
  EXPECT_EQ(message.rfind("a.yaml:2: unknown key 'stepp_s'; did you mean 'step_s'?", 0), 0u) << message;
  EXPECT_NE(message.find("name, step_s, mode"), std::string::npos) << message;
}

TEST(YamlMap, SaysWhichKeyIsMissing) {
  EXPECT_EQ(refusal([] {
              return parse("a:\n  b: 1\n  c: 2\n").map({"a"})["a"].map({"b", "c", "d"})["d"];
            }),
            "a.yaml:1: a: expected the key 'd', found only b, c");
  EXPECT_EQ(refusal([] { return parse("{}").map({"d"})["d"]; }), "a.yaml:1: expected the key 'd', found none");
}

TEST(YamlMap, TakesDefaultsForWhatIsNotThere) {
  const YamlMap map = parse("a: 1\nb: true\n").map({"a", "b", "c"});
  EXPECT_EQ(map.numberOr("a", {}, 7.0), 1.0);
  EXPECT_EQ(map.numberOr("c", {}, 7.0), 7.0);
  EXPECT_EQ(map.integerOr("a", 0, 9, 7), 1);
  EXPECT_EQ(map.integerOr("c", 0, 9, 7), 7);
  EXPECT_TRUE(map.booleanOr("b", false));
  EXPECT_TRUE(map.booleanOr("c", true));
  EXPECT_TRUE(map.has("a"));
  EXPECT_FALSE(map.has("c"));
}

TEST(YamlMap, GivesEntriesOfUnknownNamesInTheOrderOfTheFile) {
  const auto entries = scalar("{b: 1, a: 2}").entries();
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].first, "b");
  EXPECT_EQ(refusal([&] { return entries[1].second.boolean(); }), "a.yaml:1: x.a: expected true or false, found '2'");
  EXPECT_EQ(refusal([] {
              return scalar("3").map({"a", "b"});
            }),
            "a.yaml:1: x: expected a map with keys out of a, b, found '3'");
}

TEST(YamlMap, RefusesAKeyGivenTwice) {
  EXPECT_EQ(refusal([] { return parse("a: 1\nb: 2\na: 3\n"); }),
            "a.yaml:3: expected each key once, found a second 'a' (the first is on line 1)");
}

TEST(YamlMap, RefusesKeysThatAreNotWords) {
  EXPECT_NE(refusal([] { return parse("[1, 2]: 3"); }).find("a.yaml:1: expected a word as the key"), std::string::npos);
  EXPECT_NE(refusal([] { return parse("~: 3"); }).find("a.yaml:1: expected a key, found nothing"), std::string::npos);
}

class NotOurYaml : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(NotOurYaml, IsRefusedWithFileAndLine) {
  const std::string message = refusal([] { return parse(GetParam().first); });
  EXPECT_EQ(message.rfind(GetParam().second, 0), 0u) << message;
}

INSTANTIATE_TEST_SUITE_P(Documents, NotOurYaml,
                         testing::Values(std::pair("a: 1\nb: [1, 2\n", "a.yaml:2: expected valid YAML, found: "),
                                         std::pair("a: 1\n b: 2\n", "a.yaml:2: expected valid YAML, found: "),
                                         std::pair("a: b: c\n", "a.yaml:1: expected valid YAML, found: "),
                                         std::pair("a: 'b\n", "a.yaml:1: expected valid YAML, found: "),
                                         std::pair("a: \"b\nc: 2\n\n", "a.yaml:2: expected valid YAML, found: "),
                                         std::pair("a: *b\n", "a.yaml:1: expected valid YAML, found: "),
                                         std::pair("a:\n\t- b\n", "a.yaml:2: expected valid YAML, found: "),
                                         std::pair("a: 1\n---\nb: 2\n",
                                                   "a.yaml:2: expected one document, found a second one"),
                                         std::pair("a: &x 1\nb: 2\n", "a.yaml:1: expected a value, found an anchor"),
                                         std::pair("&x a: 1\n", "a.yaml:1: expected a value, found an anchor"),
                                         std::pair("a: &x [1]\nb: *x\n", "a.yaml:1: expected a value, found an anchor"),
                                         std::pair("a: !!float 1\n", "a.yaml:1: expected a plain value, found a tag")));

TEST(YamlDocument, MayBeEmptyUntilSomethingIsAskedOfIt) {
  for (const char* text : {"", "# a comment\n", "---\n", "~"}) {
    EXPECT_EQ(refusal([&] { return parse(text).map({"a"}); }),
              "a.yaml:1: expected a map with keys out of a, found nothing");
  }
}

TEST(YamlDocument, IsRefusedBeforeItsDepthCostsAnything) {
  const std::string expected = "a.yaml:1: expected at most 16 lists and maps within each other, found more";
  EXPECT_NO_THROW((void)parse(std::string(16, '[') + std::string(16, ']')));
  EXPECT_EQ(refusal([] { return parse(std::string(17, '[') + std::string(17, ']')); }), expected);
  std::string maps;
  for (int i = 0; i < 1000; ++i) maps += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  EXPECT_NE(refusal([&] { return parse(maps); }).find("at most 16 lists and maps"), std::string::npos);
  for (const char* opening : {"[", "{", "- ", "? ", "{a: ", "[{", "\"", "&", "!", "|\n"}) {
    std::string endless;
    while (endless.size() < kMaxYamlBytes / 8) endless += opening;
    EXPECT_EQ(refusal([&] { return parse(endless); }).rfind("a.yaml:", 0), 0u) << opening;
  }
}

TEST(YamlDocument, IsRefusedAboveItsSize) {
  EXPECT_EQ(refusal([] { return parse(std::string(kMaxYamlBytes + 1, ' ')); }),
            "a.yaml:1: expected at most 1048576 bytes, found 1048577");
}

TEST(YamlDocument, IsTextWithoutZeroBytes) {
  EXPECT_EQ(refusal([] { return parse(std::string("a: 1\nb\0: 2", 10)); }),
            "a.yaml:2: expected text, found a zero byte");
}

TEST(YamlDocument, OutlivesItsRoot) {
  std::optional<YamlNode> kept;
  {
    const YamlNode root = parse("a: {b: [1, 2]}");
    kept = root.map({"a"})["a"].map({"b"})["b"];
  }
  EXPECT_EQ(kept->numbers(2), (std::vector<double>{1.0, 2.0}));
}

TEST(YamlMessage, ShowsForeignTextShortAndWithoutControlCharacters) {
  const std::string message = refusal([] { return scalar("\"\\e[2J" + std::string(500, 'a') + "\"").boolean(); });
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
  EXPECT_LT(message.size(), 200u);
  EXPECT_LT(refusal([] { return parse(std::string(900, 'k') + ": 1").map({"a"}); }).size(), 200u);
}

TEST(YamlFile, ThatCannotBeReadIsNamed) {
  EXPECT_EQ(refusal([] { return readYamlFile("no/such/file.yaml"); }),
            "no/such/file.yaml: expected a file that can be read, found: No such file or directory");
  EXPECT_EQ(refusal([] { return readYamlFile("/"); }), "/: expected a file, found a folder");
  EXPECT_EQ(refusal([] { return readYamlFile("/dev/zero"); }),
            "/dev/zero: expected a file, found a device, a pipe or a socket");
}

TEST(YamlFile, ThatIsAPipeIsNotWaitedFor) {
  const std::string pipe = testing::TempDir() + "pipe_" + std::to_string(getpid());
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(refusal([&] { return readYamlFile(pipe); }),
            pipe + ": expected a file, found a device, a pipe or a socket");
  std::filesystem::remove(pipe);
}

TEST(YamlFile, ThatIsTooLargeIsNotReadToItsEnd) {
  const std::string file = testing::TempDir() + "large_" + std::to_string(getpid());
  std::ofstream(file).close();
  std::filesystem::resize_file(file, std::uintmax_t{1} << 40);
  EXPECT_NE(refusal([&] { return readYamlFile(file); }).find("expected a file of at most 1048576 bytes"),
            std::string::npos);
  std::filesystem::remove(file);
}

TEST(YamlFile, OfAnotherFormatIsToldWhatItIs) {
  const std::string file = testing::TempDir() + "other_format_" + std::to_string(getpid());
  const auto refusalOf = [&](const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
    return refusal([&] { return readYamlFile(file); });
  };
  EXPECT_EQ(refusalOf("\n<?xml version=\"1.0\"?>\n<robot name=\"arm\"/>\n").find(file + ": expected YAML, found XML"),
            0U);
  EXPECT_EQ(refusalOf("\x89MCAP0\r\n" + std::string(3 << 20, 'x')).find(file + ": expected YAML, found a recording"),
            0U);
  using namespace std::string_literals;
  for (const auto& [text, found] :
       {std::pair("\x1f\x8b\x08\0\0"s, "a file that is compressed with gzip: decompress it with `gunzip` first"),
        std::pair("PK\x03\x04\0"s, "a file that is a zip archive: take the file out of it with `unzip` first"),
        std::pair("#ROSBAG V2.0\n"s, "a file that is a ROS 1 bag; give a file that ends in .yaml"),
        std::pair("SQLite format 3\0"s, "a file that is an SQLite database, as rosbag2 records in (.db3); give"),
        std::pair("\xff\xfen\0a\0"s, "text in UTF-16; save it as UTF-8"),
        std::pair("\0n\0a"s, "text in UTF-16; save it as UTF-8")}) {
    const std::string message = refusalOf(text);
    EXPECT_EQ(message.find(file + ": expected YAML, found " + found), 0U) << message;
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace baton
