#include "scene/strict_json.hpp"

#include "flotsam/core/contracts.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace flotsam::scene {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b)
{
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = k;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t k = 1; k <= b.size(); ++k) {
            const std::size_t replaced = diagonal + (a[i - 1] == b[k - 1] ? 0 : 1);
            diagonal = row[k];
            row[k] = std::min({replaced, row[k] + 1, row[k - 1] + 1});
        }
    }
    return row.back();
}

std::string shown(const Json& value)
{
    std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

std::string range_words(Allowed allowed, const char* noun)
{
    std::string words = noun;
    if (allowed.range == Allowed::Range::positive) words += " > 0";
    if (allowed.range == Allowed::Range::not_negative) words += " >= 0";
    if (*allowed.unit) words += std::string(" [") + allowed.unit + "]";
    return words;
}

bool has_sign(double value, Allowed allowed)
{
    if (!std::isfinite(value)) return false;
    if (allowed.range == Allowed::Range::positive) return value > 0.0;
    return allowed.range == Allowed::Range::any || value >= 0.0;
}

bool is_within(double value, Allowed allowed)
{
    return std::abs(value) <= allowed.most && (allowed.range != Allowed::Range::positive || value >= allowed.least);
}

std::string limit_words(Allowed allowed)
{
    std::ostringstream words;
    words << "a number ";
    if (allowed.range == Allowed::Range::positive && allowed.least > 0.0)
        words << "from " << allowed.least << " to " << allowed.most;
    else if (allowed.range == Allowed::Range::any)
        words << "from " << -allowed.most << " to " << allowed.most;
    else
        words << "of at most " << allowed.most;
    if (*allowed.unit) words << " [" << allowed.unit << "]";
    return words.str();
}

std::string joined_words(std::initializer_list<const char*> words, const char* last)
{
    std::string text;
    std::size_t k = 0;
    for (const char* word : words) {
        if (k > 0) text += k + 1 == words.size() ? last : ", ";
        text += std::string("\"") + word + "\"";
        ++k;
    }
    return text;
}

} // namespace

std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates)
{
    const auto nearer = [&](const std::string& a, const std::string& b) {
        return edit_distance(word, a) < edit_distance(word, b);
    };
    const auto best = std::min_element(candidates.begin(), candidates.end(), nearer);
    return best == candidates.end() ? std::string() : *best;
}

void JsonNode::refuse(const std::string& what) const
{
    throw InputError(name_ + ": " + (path_.empty() ? std::string("the scene") : path_) + " " + what);
}

void JsonNode::refuse_value(const std::string& what) const
{
    refuse(what + ", given " + shown(*value_));
}

JsonNode JsonNode::child(const std::string& key) const
{
    return {value_->at(key), name_, path_.empty() ? key : path_ + "." + key};
}

std::vector<JsonNode> JsonNode::entries() const
{
    if (!value_->is_array()) refuse_value("must be a list [...]");
    std::vector<JsonNode> nodes;
    for (std::size_t k = 0; k < value_->size(); ++k)
        nodes.emplace_back((*value_)[k], name_, path_ + "[" + std::to_string(k) + "]");
    return nodes;
}

double JsonNode::number(Allowed allowed) const
{
    if (!value_->is_number() || !has_sign(value_->get<double>(), allowed))
        refuse_value("must be " + range_words(allowed, "a number"));
    if (!is_within(value_->get<double>(), allowed)) refuse_value("must be " + limit_words(allowed));
    return value_->get<double>();
}

int JsonNode::integer(int at_least, int at_most) const
{
    const double value = value_->is_number() ? value_->get<double>() : std::nan("");
    if (!(value >= at_least && value <= at_most && value == std::floor(value)))
        refuse_value("must be a whole number from " + std::to_string(at_least) + " to " + std::to_string(at_most));
    return static_cast<int>(value);
}

bool JsonNode::boolean() const
{
    if (!value_->is_boolean()) refuse_value("must be true or false");
    return value_->get<bool>();
}

std::string JsonNode::text() const
{
    if (!value_->is_string() || value_->get_ref<const std::string&>().empty()) refuse_value("must be a text \"...\"");
    return value_->get<std::string>();
}

std::vector<double> JsonNode::numbers(std::initializer_list<std::size_t> lengths, const char* of, Allowed allowed) const
{
    const bool fits = value_->is_array() && std::find(lengths.begin(), lengths.end(), value_->size()) != lengths.end();
    if (!fits) refuse_value("must be " + range_words({Allowed::Range::any, allowed.unit}, of));
    std::vector<double> values;
    for (const JsonNode& entry : entries()) values.push_back(entry.number(allowed));
    return values;
}

std::size_t JsonNode::one_of(std::initializer_list<const char*> words) const
{
    if (value_->is_string()) {
        const auto found = std::find(words.begin(), words.end(), value_->get_ref<const std::string&>());
        if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    }
    refuse_value("must be " + joined_words(words, " or "));
}

JsonObject::JsonObject(JsonNode node, std::initializer_list<const char*> keys) : node_(std::move(node))
{
    if (!node_.json().is_object()) node_.refuse_value("must be an object {...}");
    const std::vector<std::string> valid(keys.begin(), keys.end());
    for (const auto& [key, value] : node_.json().items())
        if (std::find(valid.begin(), valid.end(), key) == valid.end())
            node_.child(key).refuse("is an unknown key; the nearest valid one is \"" + nearest_word(key, valid) + "\"");
}

JsonNode JsonObject::required(const char* key) const
{
    if (!has(key)) node_.refuse(std::string("lacks the required key \"") + key + "\"");
    return node_.child(key);
}

std::optional<JsonNode> JsonObject::find(const char* key) const
{
    return has(key) ? std::optional(node_.child(key)) : std::nullopt;
}

std::vector<JsonNode> JsonObject::list(const char* key) const
{
    return has(key) ? node_.child(key).entries() : std::vector<JsonNode>();
}

void JsonObject::read(const char* key, double& into, Allowed allowed) const
{
    if (has(key)) into = node_.child(key).number(allowed);
}

std::string JsonObject::exactly_one(std::initializer_list<const char*> keys) const
{
    std::vector<std::string> there;
    for (const char* key : keys)
        if (has(key)) there.emplace_back(key);
    if (there.empty()) node_.refuse("must have one of " + joined_words(keys, " or "));
    if (there.size() > 1)
        node_.refuse("has both \"" + there[0] + "\" and \"" + there[1] + "\", and only one of them is allowed");
    return there.front();
}

} // namespace flotsam::scene
