#include "kluft/scene/scene_tree.hpp"

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/scene/scene_text.hpp"

namespace kluft {

namespace {

constexpr std::size_t widest_line = 160;
constexpr std::size_t longest_quote = 60;
constexpr std::size_t most_messages = 1000;
constexpr std::size_t most_keys = 10'000; ///< of one mapping

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

/// Control characters could move the cursor or colour the terminal.
std::string printable(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = c == '\t' ? ' ' : '?';
    return result;
}

/// text[from, from + length), both ends moved to whole UTF-8 characters.
std::string_view window(std::string_view text, std::size_t from, std::size_t length) {
    while (from > 0 && from < text.size() && continues_character(text[from])) --from;
    std::size_t end = std::min(text.size(), from + length);
    while (end < text.size() && end > from && continues_character(text[end])) --end;
    return text.substr(from, end - from);
}

/// Stops yaml-cpp in the middle of a document.
struct TooDeep {};

/// Builds the tree from yaml-cpp's events.
class TreeBuilder : public YAML::EventHandler {
public:
    TreeBuilder(int source, const TextPosition& origin, std::string_view text, SceneErrors& errors)
        : source_(source), origin_(origin), text_(text), errors_(errors) {}

    SceneNode root;
    int n_documents = 0;

    void OnDocumentStart(const YAML::Mark& mark) override {
        if (++n_documents == 2) errors_.add(position(mark), {}, "expected one document, found a second one");
    }
    void OnDocumentEnd() override {}

    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        refuse_anchor(mark, anchor);
        SceneNode node = node_at(mark, SceneNode::Kind::nothing);
        node.removes = says_nothing(mark);
        if (!node.removes) node.at = place_without_value(mark);
        insert(std::move(node));
    }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
        errors_.add(position(mark), {}, "expected a value, found an alias (*name), which scenes do not have");
        insert(node_at(mark, SceneNode::Kind::nothing));
    }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override {
        refuse_anchor(mark, anchor);
        refuse_tag(mark, tag);
        SceneNode node = node_at(mark, SceneNode::Kind::scalar);
        const bool is_text = is_utf8(value); // the parser makes single bytes of \N and \_
        if (!is_text)
            errors_.add(position(mark), {}, "expected a text in UTF-8, found an escape (\\N or \\_) that makes none");
        node.text = is_text ? value : "";
        node.quoted = tag == "!";
        insert(std::move(node));
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value /*style*/) override {
        open(mark, tag, anchor, SceneNode::Kind::list);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value /*style*/) override {
        open(mark, tag, anchor, SceneNode::Kind::mapping);
    }
    void OnMapEnd() override { close(); }

private:
    [[nodiscard]] TextPosition position(const YAML::Mark& mark) const {
        const int line = std::max(mark.line, 0);
        const int column = std::max(mark.column, 0);
        return {source_, origin_.line + line, line == 0 ? origin_.column + column : column + 1};
    }
    /// Whether `null` or `~` is written at a mark.
    [[nodiscard]] bool says_nothing(const YAML::Mark& mark) const {
        if (mark.pos < 0 || static_cast<std::size_t>(mark.pos) >= text_.size()) return false;
        const std::string_view rest = text_.substr(static_cast<std::size_t>(mark.pos));
        const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n,]}#"));
        return word == "~" || word == "null" || word == "Null" || word == "NULL";
    }
    /// Where a value is missing: at its key, or at the dash of a list's item; the mark is at what comes next.
    [[nodiscard]] TextPosition place_without_value(const YAML::Mark& mark) const {
        if (open_.empty()) return position(mark);
        const SceneNode& parent = open_.back();
        if (parent.is_mapping() && parent.keys.size() > parent.items.size()) return parent.keys.back().at;
        const auto here = static_cast<std::size_t>(std::max(mark.pos, 1));
        const auto dash = text_.rfind('-', here - 1);
        if (!parent.is_list() || dash == std::string_view::npos) return position(mark);
        const auto line_end = text_.rfind('\n', dash);
        YAML::Mark at = mark;
        at.line -= static_cast<int>(std::ranges::count(text_.substr(dash, here - dash), '\n'));
        at.column = static_cast<int>(line_end == std::string_view::npos ? dash : dash - line_end - 1);
        return position(at);
    }
    [[nodiscard]] SceneNode node_at(const YAML::Mark& mark, SceneNode::Kind kind) const {
        SceneNode node;
        node.kind = kind;
        node.at = position(mark);
        return node;
    }
    void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
        if (anchor != 0)
            errors_.add(position(mark), {}, "expected a value, found an anchor (&name), which scenes do not have");
    }
    void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
        if (!tag.empty() && tag != "?" && tag != "!")
            errors_.add(position(mark), {},
                        fmt::format("expected a value, found the tag {}, which scenes do not have", in_quotes(tag)));
    }
    void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, SceneNode::Kind kind) {
        refuse_anchor(mark, anchor);
        refuse_tag(mark, tag);
        if (static_cast<int>(open_.size()) >= deepest_level) {
            errors_.add(position(mark), {}, fmt::format("expected at most {} levels of nesting", deepest_level));
            throw TooDeep{};
        }
        open_.push_back(node_at(mark, kind));
    }
    void close() {
        SceneNode node = std::move(open_.back());
        open_.pop_back();
        if (node.keys.size() > node.items.size()) node.keys.resize(node.items.size());
        insert(std::move(node));
    }
    /// Hands a complete node to the container in progress: as a key where a mapping waits for one.
    void insert(SceneNode node) {
        if (open_.empty()) {
            if (n_documents == 1) root = std::move(node);
            return;
        }
        SceneNode& parent = open_.back();
        if (parent.is_mapping() && parent.keys.size() == parent.items.size()) {
            if (!node.is_scalar()) errors_.add(node.at, {}, "expected a word as the key, found something else");
            parent.keys.push_back({node.text, node.at, node.is_scalar()});
        } else {
            parent.items.push_back(std::move(node));
        }
    }

    int source_;
    TextPosition origin_;
    std::string_view text_;
    SceneErrors& errors_;
    std::vector<SceneNode> open_;
};

/// Entries whose key is no word go. yaml-cpp keeps both entries of a duplicate key; the first one stays.
void remove_refused(SceneNode& node, const std::string& path, SceneErrors& errors) {
    std::set<std::string, std::less<>> seen;
    std::vector<SceneKey> keys;
    std::vector<SceneNode> items;
    for (std::size_t i = 0; i < node.items.size(); ++i) {
        if (node.is_mapping() && !node.keys[i].is_word) continue;
        const std::string name = node.is_mapping() ? node.keys[i].text : std::to_string(i);
        const std::string item_path = joined_path(path, name);
        if (node.is_mapping() && !seen.insert(name).second) {
            const bool begins_with_digit = !name.empty() && name.front() >= '0' && name.front() <= '9';
            errors.add(node.keys[i].at, item_path,
                       fmt::format("expected each key once, found {} again{}", in_quotes(name),
                                   begins_with_digit ? "; decimals have a point, and a comma begins a key" : ""));
            continue;
        }
        if (node.is_mapping() && keys.size() == most_keys) {
            errors.add(node.keys[i].at, path, fmt::format("expected at most {} keys", most_keys));
            break;
        }
        remove_refused(node.items[i], item_path, errors);
        if (node.is_mapping()) keys.push_back(std::move(node.keys[i]));
        items.push_back(std::move(node.items[i]));
    }
    node.keys = std::move(keys);
    node.items = std::move(items);
}

std::vector<std::string> split_lines(std::string_view text) {
    std::vector<std::string> lines;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        lines.emplace_back(text.substr(0, end));
        if (end == std::string_view::npos) break;
        text.remove_prefix(end + 1);
    }
    return lines;
}

} // namespace

const SceneNode* SceneNode::find(std::string_view key) const {
    const auto found = std::find_if(keys.begin(), keys.end(), [&](const SceneKey& k) { return k.text == key; });
    return found == keys.end() ? nullptr : &items[static_cast<std::size_t>(found - keys.begin())];
}

SceneNode* SceneNode::find(std::string_view key) { return const_cast<SceneNode*>(std::as_const(*this).find(key)); }

TextPosition SceneNode::place_without(std::string_view key) const {
    const auto last = std::find_if(removed.rbegin(), removed.rend(), [&](const SceneKey& k) { return k.text == key; });
    return last == removed.rend() ? at : last->at;
}

void SceneNode::remove(std::string_view key, const TextPosition& said_at) {
    const auto index = find(key) - items.data();
    removed.push_back({keys[static_cast<std::size_t>(index)].text, said_at});
    keys.erase(keys.begin() + index);
    items.erase(items.begin() + index);
}

int SceneSources::add_file(const std::filesystem::path& file, std::string_view text) {
    sources_.push_back({printable(file.string()), file.parent_path(), split_lines(text)});
    return static_cast<int>(sources_.size()) - 1;
}

int SceneSources::add_override(const std::string& assignment) {
    sources_.push_back({fmt::format("--set {}", printable(window(assignment, 0, widest_line))),
                        sources_.empty() ? std::filesystem::path{} : sources_.front().directory,
                        {}});
    return static_cast<int>(sources_.size()) - 1;
}

std::string SceneSources::place(const TextPosition& at) const {
    const Source& source = sources_.at(at.source);
    return source.lines.empty() ? source.name : fmt::format("{}:{}:{}", source.name, at.line, at.column);
}

std::string SceneSources::file(const TextPosition& at) const {
    const Source& source = sources_.at(at.source);
    return source.lines.empty() ? std::string{} : source.name;
}

const std::filesystem::path& SceneSources::directory(const TextPosition& at) const {
    return sources_.at(at.source).directory;
}

std::string SceneSources::line(const TextPosition& at) const {
    const auto& lines = sources_.at(at.source).lines;
    if (at.line < 1 || at.line > static_cast<int>(lines.size())) return {};
    std::string_view text = lines[at.line - 1];
    while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.remove_suffix(1);
    if (text.size() <= widest_line) return printable(text);
    const auto column = static_cast<std::size_t>(std::max(at.column - 1, 0));
    const std::size_t from = column < widest_line / 2 ? 0 : std::min(column - widest_line / 2, text.size());
    return fmt::format("{}{}...", from > 0 ? "..." : "", printable(window(text, from, widest_line)));
}

void SceneErrors::add(const TextPosition& at, const std::string& path, const std::string& what) {
    std::string message = sources_.place(at) + ": ";
    if (!path.empty()) message += printable(path) + ": ";
    message += what;
    const std::string line = sources_.line(at);
    if (!line.empty()) message += fmt::format("\n  {}", line);
    InputProblem problem{std::move(message), what, printable(path), sources_.file(at)};
    if (!problem.file.empty()) std::tie(problem.line, problem.column) = std::pair(at.line, at.column);
    errors_.push_back({at, std::move(problem)});
}

void SceneErrors::throw_if_any() const {
    if (errors_.empty()) return;
    std::vector<Error> sorted = errors_;
    std::stable_sort(sorted.begin(), sorted.end(), [](const Error& a, const Error& b) {
        return std::tie(a.at.source, a.at.line, a.at.column) < std::tie(b.at.source, b.at.line, b.at.column);
    });
    std::vector<InputProblem> problems;
    for (auto& error : sorted) {
        if (problems.size() == most_messages) {
            problems.push_back({.message = fmt::format("and {} more", sorted.size() - most_messages)});
            break;
        }
        problems.push_back(std::move(error.problem));
    }
    throw InputError(std::move(problems));
}

std::string in_quotes(std::string_view text) {
    const bool whole = text.size() <= longest_quote;
    return fmt::format("'{}{}'", printable(whole ? text : window(text, 0, longest_quote)), whole ? "" : "...");
}

std::string joined_path(const std::string& path, std::string_view key) {
    return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

namespace {

/// Names the first line that a tab indents, which is the mistake then; empty where there is none.
std::string tab_remark(std::string_view text, int first_line) {
    for (int line = first_line;; ++line) {
        const std::string_view rest = text.substr(0, text.find('\n'));
        const std::size_t indentation = rest.find_first_not_of(" \t");
        if (indentation != std::string_view::npos && rest.find('\t') < indentation)
            return fmt::format("; line {} is indented by a tab, where YAML wants spaces", line);
        if (rest.size() == text.size()) return {};
        text.remove_prefix(rest.size() + 1);
    }
}

} // namespace

SceneNode parse_scene_tree(std::string_view text, int source, const TextPosition& origin, SceneErrors& errors) {
    std::istringstream stream{std::string(text)};
    TreeBuilder builder(source, origin, text, errors);
    try {
        YAML::Parser parser(stream);
        while (builder.n_documents < 2 && parser.HandleNextDocument(builder)) {
        }
    } catch (const YAML::Exception& error) {
        const TextPosition at{source, origin.line + std::max(error.mark.line, 0),
                              std::max(error.mark.column, 0) + (error.mark.line > 0 ? 1 : origin.column)};
        errors.add(at, {},
                   fmt::format("expected valid YAML, found a mistake: {}{}", error.msg, tab_remark(text, origin.line)));
        return {};
    } catch (const TooDeep&) {
        return {};
    }
    remove_refused(builder.root, {}, errors);
    return std::move(builder.root);
}

void merge_scene_trees(SceneNode& base, SceneNode over) {
    if (!base.is_mapping() || !over.is_mapping()) {
        base = std::move(over);
        return;
    }
    base.at = over.at;
    for (std::size_t i = 0; i < over.keys.size(); ++i) {
        const auto& key = over.keys[i];
        SceneNode* existing = base.find(key.text);
        if (existing == nullptr) {
            base.keys.push_back(key);
            base.items.push_back(std::move(over.items[i]));
        } else if (over.items[i].removes) {
            base.remove(key.text, key.at);
        } else {
            base.keys[static_cast<std::size_t>(existing - base.items.data())] = key;
            merge_scene_trees(*existing, std::move(over.items[i]));
        }
    }
}

} // namespace kluft
