#include "kluft/scene/scene_reference.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "kluft/scene/json_schema.hpp"
#include "kluft/scene/scene_reader.hpp"
#include "kluft/scene/scene_schema.hpp"

namespace kluft {
namespace {

/// The documentation is generated: `KLUFT_WRITE_DOCS=1 kluft_tests --gtest_filter='SceneReference.*'` after a change of
/// the table of keys.
TEST(SceneReference, PageInTheDocumentationIsTheTableOfKeys) {
    const std::string file = KLUFT_SOURCE_DIR "/docs/scene.md";
    const std::string page = scene_reference_markdown();
    if (std::getenv("KLUFT_WRITE_DOCS") != nullptr) std::ofstream(file) << page;
    std::ifstream stream(file);
    std::stringstream written;
    written << stream.rdbuf();
    EXPECT_EQ(written.str(), page) << "write it anew with KLUFT_WRITE_DOCS=1";
}

TEST(SceneReference, ExampleInThePageIsAValidScene) {
    const std::string page = scene_reference_markdown();
    const auto start = page.find("```yaml\n") + 8;
    const Scene scene = read_scene_text(page.substr(start, page.find("```", start) - start));
    EXPECT_EQ(scene.loads.stages.size(), 2U);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(SceneReference, PageAndJsonSchemaNameEveryKey) {
    const std::string page = scene_reference_markdown();
    const auto schema = nlohmann::json::parse(json_schema(scene_schema(), "Kluft scene", Extending::possible));
    EXPECT_EQ(schema.at("properties").size(), scene_schema().child_keys("").size());
    for (const auto& rule : scene_schema()) {
        EXPECT_FALSE(rule.doc.empty()) << rule.path;
        const std::string last(rule.path.substr(rule.path.rfind('.') + 1));
        if (last == "*" || last == "#") continue;
        EXPECT_NE(page.find(last), std::string::npos) << rule.path;
    }
    EXPECT_EQ(schema.at("then").at("required"), (nlohmann::json{"kluft", "materials", "geometry", "stages"}));
}

} // namespace
} // namespace kluft
