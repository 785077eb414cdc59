#include "flotsam/core/contracts.hpp"
#include "scene/strict_json.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace flotsam::scene {
namespace {

/// Why a text is no JSON.
struct SyntaxError {
    std::string sentence;
    bool overflow = false; ///< of a number that is not finite or of the nesting, the rest may be right
};

/// No scene comes near; what prints a value goes down with its levels, and a deep file must not take the stack.
constexpr std::size_t kDeepest = 32;

/// Builds the document; unlike nlohmann's own builder it refuses keys that come twice and keeps the place of an error.
class StrictBuilder final : public nlohmann::json_sax<Json> {
  public:
    explicit StrictBuilder(std::string_view text) : text_(text) {}

    Json root;
    SyntaxError error;

    bool null() override { return add(nullptr); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(number_integer_t value) override { return add(value); }
    bool number_unsigned(number_unsigned_t value) override { return add(value); }
    bool number_float(number_float_t value, const string_t&) override { return add(value); }
    bool string(string_t& value) override { return add(std::move(value)); }
    bool binary(binary_t&) override { return false; }
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& name) override
    {
        if (open_.back()->contains(name)) {
            error.sentence = path() + name + " is there twice";
            return false;
        }
        keys_.back() = name;
        return true;
    }

    bool parse_error(std::size_t position, const std::string& last_token,
                     const nlohmann::detail::exception& what) override
    {
        const std::string_view before = text_.substr(0, std::min(position, text_.size()));
        const auto line = 1 + std::count(before.begin(), before.end(), '\n');
        const std::size_t last_newline = before.rfind('\n');
        const std::size_t column = before.size() - (last_newline == before.npos ? 0 : last_newline + 1);
        error.overflow = dynamic_cast<const nlohmann::detail::out_of_range*>(&what) != nullptr;
        const std::string word = word_before(before.size());
        error.sentence = "line " + std::to_string(line) + ", column " + std::to_string(column) + near() + ": ";
        if (error.overflow)
            error.sentence += "the number " + last_token + " is not finite";
        else if (is_no_finite_number(word))
            error.sentence += "not JSON: numbers must be finite, given " + word;
        else
            error.sentence += reason(what.what());
        return false;
    }

  private:
    /// What stands behind "[json.exception...] parse error at line 1, column 2: ".
    static std::string reason(std::string_view what)
    {
        const std::size_t column = what.find("column ");
        const std::size_t colon = what.find(": ", column == what.npos ? 0 : column);
        return "not JSON: " + std::string(colon == what.npos ? what : what.substr(colon + 2));
    }

    /// The bare word that the text of this size ends in the middle of.
    std::string word_before(std::size_t size) const
    {
        constexpr std::string_view kEnds = " \t\r\n,:[]{}\"";
        const std::size_t before = size == 0 ? text_.npos : text_.find_last_of(kEnds, size - 1);
        const std::size_t begin = before == text_.npos ? 0 : before + 1;
        const std::size_t end = std::min(text_.find_first_of(kEnds, begin), text_.size());
        return std::string(text_.substr(begin, std::min<std::size_t>(end - begin, 20)));
    }

    static bool is_no_finite_number(std::string word)
    {
        for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        if (word.starts_with('-') || word.starts_with('+')) word.erase(0, 1);
        return word == "nan" || word == "inf" || word == "infinity";
    }

    /// The value that was read last or is read now.
    std::string near() const
    {
        if (open_.empty()) return {};
        std::string place = path();
        if (!open_.back()->is_array())
            place += keys_.back();
        else if (!place.empty())
            place.pop_back();
        if (open_.back()->is_array()) place += "[" + std::to_string(open_.back()->size()) + "]";
        if (place.ends_with('.')) place.pop_back();
        return place.empty() ? place : ", near " + place;
    }

    std::string path() const
    {
        std::string text;
        for (std::size_t k = 0; k + 1 < open_.size(); ++k)
            text += open_[k]->is_array() ? "[" + std::to_string(open_[k]->size() - 1) + "]"
                                         : (text.empty() ? "" : ".") + keys_[k];
        return text.empty() ? text : text + ".";
    }

    Json* place(Json value)
    {
        if (open_.empty()) return &(root = std::move(value));
        if (open_.back()->is_array()) return &open_.back()->emplace_back(std::move(value));
        return &((*open_.back())[keys_.back()] = std::move(value));
    }
    bool add(Json value)
    {
        place(std::move(value));
        return true;
    }
    bool open(Json value)
    {
        if (open_.size() == kDeepest) {
            error = {"lists and objects are more than " + std::to_string(kDeepest) + " levels deep", true};
            return false;
        }
        open_.push_back(place(std::move(value)));
        keys_.emplace_back();
        return true;
    }
    bool close()
    {
        open_.pop_back();
        keys_.pop_back();
        return true;
    }

    std::string_view text_;
    std::vector<Json*> open_; ///< objects and lists around the place that is read; none grows while one in it is open
    std::vector<std::string> keys_;
};

std::vector<std::string> path_segments(const std::string& path)
{
    std::vector<std::string> segments(1);
    for (const char c : path) {
        if (c == '.' || c == '[')
            segments.emplace_back();
        else if (c != ']')
            segments.back() += c;
    }
    return segments;
}

/// The entry of a list that an index or a name stands for.
Json& list_entry(Json& list, const std::string& segment, const std::string& where)
{
    std::size_t index = list.size();
    const auto [end, failed] = std::from_chars(segment.data(), segment.data() + segment.size(), index);
    if (failed == std::errc() && end == segment.data() + segment.size()) {
        if (index < list.size()) return list[index];
        throw InputError(where + ": the list has " + std::to_string(list.size()) + " entries, counted from 0");
    }
    std::vector<std::string> names;
    for (Json& entry : list) {
        if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string()) continue;
        if (entry["name"] == segment) return entry;
        names.push_back(entry["name"]);
    }
    throw InputError(
        where + ": no entry of that list has this index or name" +
        (names.empty() ? std::string() : "; the nearest name is \"" + nearest_word(segment, names) + "\""));
}

Json override_value(const std::string& text, const std::string& where)
{
    StrictBuilder builder(text);
    if (Json::sax_parse(text, &builder)) return builder.root;
    const bool meant_as_json =
        builder.error.overflow || (!text.empty() && std::string("[{\"").find(text[0]) != std::string::npos);
    if (meant_as_json) throw InputError(where + ": " + builder.error.sentence);
    return text;
}

} // namespace

Json parse_strictly(std::string_view text, const std::string& name)
{
    StrictBuilder builder(text);
    if (!Json::sax_parse(text, &builder)) throw InputError(name + ": " + builder.error.sentence);
    return builder.root;
}

void apply_override(Json& document, const std::string& path_and_value, const std::string& name)
{
    const std::size_t equals = path_and_value.find('=');
    const bool is_long = path_and_value.size() > 80;
    const std::string where = name + ": --set " + (is_long ? path_and_value.substr(0, 77) + "..." : path_and_value);
    if (equals == std::string::npos || equals == 0)
        throw InputError(where + ": must be path=value, like bodies.0.density=300");
    Json* place = &document;
    for (const std::string& segment : path_segments(path_and_value.substr(0, equals))) {
        if (segment.empty()) throw InputError(where + ": the path has an empty part");
        if (place->is_array())
            place = &list_entry(*place, segment, where);
        else if (place->is_object() || place->is_null())
            place = &(*place)[segment]; // a key that should not be there is refused by the reader, with its path
        else
            throw InputError(where + ": there is no \"" + segment + "\" in " + place->dump());
    }
    *place = override_value(path_and_value.substr(equals + 1), where);
}

} // namespace flotsam::scene
