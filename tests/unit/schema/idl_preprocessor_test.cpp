/// What is left out of IDL texts, and what stands in the place of a name.
#include "schema/idl_preprocessor.hpp"

#include <gtest/gtest.h>

#include <string>

#include "schema/limits.hpp"
#include "unit/schema/decoded.hpp"

namespace baton::schema {
namespace {

using test::decoded;

std::string repeat(const std::string& text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

/// "a" where the lines between a condition and its end are read, else "b".
std::string branch(const std::string& condition, const std::string& before = "") {
  const std::string text = before + "\nstruct S {\n" + condition + "\noctet a;\n#else\noctet b;\n#endif\n};";
  const std::string found = decoded(text, {1});
  return found.ends_with("=1") ? found.substr(0, 1) : found;
}

TEST(IdlPreprocessor, LeavesOutWhatIsNotTaken) {
  for (const char* condition : {"#if 1", "#if !0", "#  if 12 // why", "#ifdef X", "#ifndef Y", "#if defined(X)",
                                "#if defined X", "#if !defined ( Y )", "#if X", "# ifdef X /* a\n b */", "#if \\\n 1",
                                "#if 0\nany c;\n#elif 1", "#ifdef Y\n#elif defined(X)"}) {
    EXPECT_EQ(branch(condition, "#define X 2\n#define Y\n#undef Y"), "a") << condition;
  }
  for (const char* condition : {"#if 0", "#if !1", "#ifdef Y", "#ifndef X", "#if !defined(X)", "#if defined(Y)",
                                "#if Z", "#if 0\nit's\n#if 1\n#endif\n#else\n#if 0", "#if 0 /* no\n#else */"}) {
    EXPECT_EQ(branch(condition, "#define X\n#define Z 0").front(), 'b') << condition;
  }
  EXPECT_EQ(decoded("#if 1\nstruct S { octet a; };\n#else\nstruct S { double a; };\n#endif", {1}), "a=1");
  EXPECT_EQ(
      decoded("#ifndef A\n#define A\nstruct S { octet a; };\n#endif\n#ifndef A\nstruct S { long a; };\n#endif", {1}),
      "a=1");
  EXPECT_EQ(decoded("#if 0\r\nstruct S { double a; };\r\n#else\r\nstruct S { octet a; };\r\n#endif\r\n", {1}), "a=1");
  EXPECT_EQ(decoded("#if 0\nstruct S { double a; };\n#endif", {1}), "no type S");
}

TEST(IdlPreprocessor, CommentsAndTextsAreNoLinesForIt) {
  EXPECT_EQ(decoded("/*\n#if 0\n*/ struct S { @unit(\"N\") octet a; // it's N\n#define N 4\n octet b[N]; };",
                    {1, 2, 3, 4, 5}),
            "a=1 b=4 octets");
  EXPECT_EQ(preprocessed("#define N 4\n\"N\" 'N' /* N */ N_ 0xN _N N\n// N"), "\n\"N\" 'N' /* N */ N_ 0xN _N 4\n// N");
  EXPECT_EQ(preprocessed("a #if 0\n b"), "a #if 0\n b") << "not at the begin of a line";
}

TEST(IdlPreprocessor, NamesHaveTheMeaningTheyAreGiven) {
  EXPECT_EQ(decoded("#define N 2 /* of\n them */\n#define M (N + \\\n 1) // more\nstruct S { octet a[M * N]; "
                    "sequence<octet, M> b; };",
                    {1, 2, 3, 4, 5, 6, 0, 0, 1, 0, 0, 0, 9}),
            "a=6 octets b=1 octets");
  EXPECT_EQ(decoded("#define N M\n#define M 4\n#undef M\n#define M 3\nstruct S { octet a[N]; };", {1, 2, 3}),
            "a=3 octets");
  EXPECT_EQ(preprocessed("#define A A B\n#define B A\nA"), "\n\nA A") << "none is replaced within itself";
  EXPECT_EQ(decoded("#define F(x) x\nstruct S { octet a[F(2)]; };", {1, 2}),
            "S: line 2: expected a whole number from 1 to 4294967295, found 'F'");
}

TEST(IdlPreprocessor, WhatCannotBeToldIsNotGuessed) {
  EXPECT_EQ(branch("#if X > 1"), "S: line 3: expected a type, found '#if X > 1'");
  EXPECT_EQ(branch("#if X"), "S: line 3: expected a type, found '#if X'");
  EXPECT_EQ(branch("#if 0\n#elif X > 1"), "S: line 4: expected a type, found '#elif X > 1'");
  EXPECT_EQ(branch("#ifdef X", "#if Y > 1\n#define X\n#endif"), "S: line 5: expected a type, found '#ifdef X'");
  EXPECT_EQ(decoded("#if Y > 1\n#define N 2\n#else\n#define N 3\n#endif\nstruct S { octet a[N]; };", {1, 2}),
            "S: line 6: expected a whole number from 1 to 4294967295, found 'N'");
  EXPECT_EQ(decoded("#if Y > 1\nstruct S { octet a; };\n#else\nstruct T { octet b; };\n#endif", {1}), "a=1");
  EXPECT_EQ(
      decoded("#endif\n#else\n#elif 0\n#include \"a.idl\"\n# 3 \"a.idl\"\n#error no\nstruct S { octet a; };", {1}),
      "a=1");
}

TEST(IdlPreprocessor, LinesStayWhereTheyAre) {
  EXPECT_EQ(decoded("#if 0\n\n/*\n*/\n#endif\n#define A \\\n 1\nstruct S { T a; };", {1}),
            "S: line 8: expected a type that was declared before, found 'T'");
}

TEST(IdlPreprocessor, AByteOrderMarkIsNoPartOfTheText) {
  EXPECT_EQ(decoded("\xEF\xBB\xBFstruct S { octet a; };", {1}), "a=1");
  EXPECT_EQ(decoded("\xEF\xBB\xBF#define N 2\nstruct S { octet a[N]; };", {1, 2}), "a=2 octets");
  EXPECT_EQ(preprocessed("\xEF\xBB\xBF"), "");
}

TEST(IdlPreprocessor, WhatATextGrowsToHasItsLimits) {
  std::string doubling = "#define A0 x\n", nothing = "#define A0\n";
  for (int i = 1; i < 31; ++i) {
    const std::string name = "A" + std::to_string(i - 1);
    const std::string line = "#define A" + std::to_string(i) + " " + name + " " + name + "\n";
    doubling += line;
    nothing += line;
  }
  EXPECT_THROW((void)preprocessed(doubling + "A30"), IdlError);
  EXPECT_THROW((void)preprocessed(nothing + "A30"), IdlError) << "many that become nothing";
  EXPECT_THROW((void)preprocessed("#define A " + std::string(200, 'x') + "\n" + repeat("A ", 10'000)), IdlError);
  EXPECT_THROW((void)preprocessed(repeat("#if 0\n", kMaxDepth + 1)), IdlError);
  EXPECT_EQ(preprocessed(repeat("#if 0\n", kMaxDepth)), std::string(kMaxDepth, '\n'));
  std::string chain = "#define A0 1\n";
  for (unsigned i = 1; i <= kMaxDepth; ++i)
    chain += "#define A" + std::to_string(i) + " A" + std::to_string(i - 1) + "\n";
  EXPECT_THROW((void)preprocessed(chain + "A" + std::to_string(kMaxDepth)), IdlError);
  EXPECT_NO_THROW((void)preprocessed(chain + "A" + std::to_string(kMaxDepth - 1)));
  for (const char* text : {"#", "#define", "#undef", "#if", "#ifdef", "#if !", "#if defined(", "#if defined)", "/*",
                           "\"", "'\\", "#define A /*", "#define A \\", "#if 0 /*"}) {
    EXPECT_NO_THROW((void)preprocessed(text)) << text;
  }
}

}  // namespace
}  // namespace baton::schema
