// What a controller says of its parameters: all that the law declares, whole.
#include "parameter_report.hpp"

#include <gtest/gtest.h>

#include "control/law.hpp"

namespace baton {
namespace {

TEST(ParameterReport, CarriesEveryDeclarationOfEveryLawWhole) {
  for (const LawInfo& law : allLaws()) {
    ControllerConfig config{.name = "one", .law = law.name, .parameters = completeParameters(law.parameters, {}, 3)};
    const msg::ParameterStatus report = parameterReport(config);
    ASSERT_EQ(report.parameters().size(), law.parameters.size()) << law.name;
    for (std::size_t i = 0; i < law.parameters.size(); ++i) {
      const ParameterSpec& spec = law.parameters[i];
      const msg::Parameter& one = report.parameters()[i];
      EXPECT_EQ(one.name().c_str(), spec.name);
      EXPECT_EQ(one.unit().c_str(), spec.unit);
      EXPECT_EQ(one.doc().c_str(), spec.doc);
      EXPECT_EQ(one.minimum(), spec.minimum);
      EXPECT_EQ(one.maximum(), spec.maximum);
      EXPECT_EQ(one.choices().size(), spec.choices.size());
      if (spec.size == ParameterSize::kChoice) {
        EXPECT_EQ(one.word().c_str(), spec.choices.front());
        EXPECT_TRUE(one.numbers().empty());
      } else {
        EXPECT_EQ(one.numbers(), numbers(config.parameters, spec.name));
      }
    }
  }
}

}  // namespace
}  // namespace baton
