/* The parser of VRML97.
 *
 * A prototype is kept as the place of its body in the text. Where it is used, the body is parsed
 * again, with the values of the instance for what IS names; so every instance has nodes of its own,
 * and nothing needs to be copied. A body sees only the prototypes declared before it, so none can
 * contain itself. Every reading again is counted, because a few prototypes inside one another could
 * keep us busy for ever. */
#include "pipeline/scene/vrml_parser.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/scene/vrml_files.h"

enum { DEPTH_MAX = 200, NODES_MAX = 1 << 18 };

#define REREAD_BYTES_MAX (256ull << 20)

static int parse_node(struct vrml_parser *parser, struct vrml_node **out);
static int parse_nodes(struct vrml_parser *parser, struct vrml_list *nodes, bool in_braces);

/* ---- values */

/* Reads one item and adds it. */
static int read_item(struct vrml_parser *parser, const struct vrml_type *type,
		     struct vrml_list *list)
{
	struct vrml_node *node = NULL;
	const char *text = NULL;
	int32_t number = 0;
	int rc = 0;

	switch (type->base) {
	case VRML_NODES:
		rc = parse_node(parser, &node);
		return rc < 0 || !node ? rc : vrml_push(parser, list, &node, sizeof(node));
	case VRML_STRINGS:
		rc = vrml_read_string(parser, &text);
		return rc < 0 ? rc : vrml_push(parser, list, &text, sizeof(text));
	case VRML_BOOLS:
		rc = vrml_read_bool(parser, &number);
		return rc < 0 ? rc : vrml_push(parser, list, &number, sizeof(number));
	case VRML_IMAGE:
		while (rc == 0 && vrml_peek(parser).kind == VRML_NUMBER) {
			rc = vrml_read_number(parser, type, &number);
			if (rc == 0)
				rc = vrml_push(parser, list, &number, sizeof(number));
		}
		return rc;
	default:
		for (int i = 0; i < type->width && rc == 0; i++) {
			rc = vrml_read_number(parser, type, &number);
			if (rc == 0)
				rc = vrml_push(parser, list, &number, sizeof(number));
		}
		return rc;
	}
}

static size_t item_bytes(const struct vrml_type *type)
{
	return type->base == VRML_NODES || type->base == VRML_STRINGS ? sizeof(void *) : 4;
}

static int read_items(struct vrml_parser *parser, const struct vrml_type *type,
		      struct vrml_list *list)
{
	struct vrml_token token;
	int rc = 0;

	if (!type->is_list || !vrml_take(parser, "["))
		return read_item(parser, type, list);
	while (rc == 0) {
		token = vrml_peek(parser);
		if (vrml_token_is(&token, "]")) {
			vrml_take_any(parser);
			return 0;
		}
		rc = read_item(parser, type, list);
	}
	return rc;
}

static int parse_value(struct vrml_parser *parser, const struct vrml_type *type,
		       const struct vrml_value **out)
{
	struct vrml_list list = { 0 };
	struct vrml_value *value = arena_alloc(&parser->scene->arena, sizeof(*value));
	int rc = value ? read_items(parser, type, &list) : vrml_fail_memory(parser);
	void *items = NULL;

	if (rc == 0) {
		items = vrml_settle(parser, &list, item_bytes(type));
		if (!items)
			rc = vrml_fail_memory(parser);
	}
	free(list.items);
	if (rc < 0)
		return rc;
	value->count = list.count;
	switch (type->base) {
	case VRML_FLOATS:
		value->floats = items;
		break;
	case VRML_STRINGS:
		value->strings = items;
		break;
	case VRML_NODES:
		value->nodes = items;
		break;
	default:
		value->integers = items;
	}
	*out = value;
	return 0;
}

/* Skips one item of a value: a word of truth, a node, or numbers and texts. */
static int skip_item(struct vrml_parser *parser)
{
	struct vrml_node *node;
	struct vrml_token token = vrml_peek(parser);

	if (vrml_take(parser, "TRUE") || vrml_take(parser, "FALSE"))
		return 0;
	if (token.kind == VRML_WORD)
		return parse_node(parser, &node);
	if (token.kind != VRML_NUMBER && token.kind != VRML_STRING)
		return vrml_fail_token(parser, &token, "a value");
	while (token.kind == VRML_NUMBER || token.kind == VRML_STRING) {
		vrml_take_any(parser);
		token = vrml_peek(parser);
	}
	return 0;
}

/* Skips the value of a field that we do not know: an item, or a list, which holds no lists. */
static int skip_value(struct vrml_parser *parser)
{
	int rc = 0;

	if (!vrml_take(parser, "["))
		return skip_item(parser);
	while (rc == 0 && !vrml_take(parser, "]"))
		rc = skip_item(parser);
	return rc;
}

/* Reads a file that the scene names, once. */
static int load(struct vrml_parser *parser, struct vrml_source **out, const struct vrml_value *urls,
		unsigned line)
{
	int rc = vrml_open_source(parser, out, urls, line);

	return rc < 0 || (*out)->is_parsed ? rc : vrml_parse_source(parser, *out);
}

/* ---- prototypes */

static const struct vrml_binding *find_binding(const struct vrml_binding *bindings, uint32_t count,
					       const char *name)
{
	for (uint32_t i = 0; i < count; i++)
		if (strcmp(bindings[i].name, name) == 0)
			return &bindings[i];
	return NULL;
}

/* Skips what stands in braces, from after the first one. */
static int skip_braces(struct vrml_parser *parser)
{
	for (unsigned depth = 1; depth > 0;) {
		struct vrml_token token = vrml_take_any(parser);

		if (token.kind == VRML_END || token.kind == VRML_BAD)
			return vrml_fail_token(parser, &token, "}");
		depth += vrml_token_is(&token, "{");
		depth -= vrml_token_is(&token, "}");
	}
	return 0;
}

/* Reads the list of a prototype's fields and events, from after its [. */
static int parse_interface(struct vrml_parser *parser, struct vrml_proto *proto, bool is_extern)
{
	struct vrml_list list = { 0 };
	int rc = 0;

	while (rc == 0 && !vrml_take(parser, "]")) {
		struct vrml_binding binding = { 0 };
		struct vrml_token kind = vrml_take_any(parser), type;
		bool is_field =
			vrml_token_is(&kind, "field") || vrml_token_is(&kind, "exposedField");

		if (!is_field && !vrml_token_is(&kind, "eventIn") &&
		    !vrml_token_is(&kind, "eventOut")) {
			rc = vrml_fail_token(parser, &kind,
					     "field, exposedField, eventIn or eventOut");
			break;
		}
		type = vrml_take_any(parser);
		binding.type = vrml_type_named(type.text, type.length);
		rc = binding.type ? vrml_take_name(parser, &binding.name, "a name")
				  : vrml_fail_token(parser, &type, "a type such as SFColor");
		if (rc == 0 && is_field && !is_extern)
			rc = parse_value(parser, binding.type, &binding.value);
		if (rc == 0)
			rc = vrml_push(parser, &list, &binding, sizeof(binding));
	}
	proto->binding_count = list.count;
	if (rc == 0) {
		proto->bindings = vrml_settle(parser, &list, sizeof(struct vrml_binding));
		rc = proto->bindings ? 0 : vrml_fail_memory(parser);
	}
	free(list.items);
	return rc;
}

static int parse_proto(struct vrml_parser *parser, bool is_extern)
{
	struct vrml_proto *proto = arena_alloc(&parser->scene->arena, sizeof(*proto));
	struct vrml_scope *scope = parser->scope;
	int rc = proto ? vrml_take_name(parser, &proto->name, "the prototype's name")
		       : vrml_fail_memory(parser);

	if (rc == 0)
		rc = vrml_expect(parser, "[");
	if (rc == 0)
		rc = parse_interface(parser, proto, is_extern);
	if (rc == 0 && is_extern)
		rc = parse_value(parser, vrml_type_named("MFString", 8), &proto->urls);
	else if (rc == 0)
		rc = vrml_expect(parser, "{");
	if (rc < 0)
		return rc;
	proto->source = scope->source;
	proto->body = scope->lexer;
	proto->before = scope->protos;
	scope->protos = proto;
	return is_extern ? 0 : skip_braces(parser);
}

static const struct vrml_proto *find_proto(const struct vrml_proto *proto, const char *name)
{
	while (proto && strcmp(proto->name, name) != 0)
		proto = proto->before;
	return proto;
}

/* Finds the body of an EXTERNPROTO in its file: "FILE#NAME", or the first one there. */
static int resolve(struct vrml_parser *parser, const struct vrml_proto **proto, unsigned line)
{
	const struct vrml_proto *found, *each;
	struct vrml_source *source;
	const char *name = NULL;
	int rc = load(parser, &source, (*proto)->urls, line);

	if (rc < 0)
		return rc;
	for (uint32_t i = 0; i < (*proto)->urls->count && !name; i++)
		name = strchr((*proto)->urls->strings[i], '#');
	found = source->protos;
	for (each = found; each; each = each->before)
		found = each;
	if (name)
		found = find_proto(source->protos, name + 1);
	if (!found || found->urls)
		return VRML_FAIL(parser, -EBADMSG, line,
				 "%s declares no PROTO %s; correct the address", source->path,
				 name ? name + 1 : (*proto)->name);
	*proto = found;
	return 0;
}

/* Reads the values that an instance gives, from after its {. */
static int parse_instance_fields(struct vrml_parser *parser, const struct vrml_proto *proto,
				 struct vrml_binding *bindings)
{
	int rc = 0;

	while (rc == 0 && !vrml_take(parser, "}")) {
		const struct vrml_binding *outer;
		struct vrml_binding *binding;
		const char *name = NULL, *outside = NULL;

		rc = vrml_take_name(parser, &name, "a field or }");
		if (rc < 0)
			break;
		binding = (struct vrml_binding *)find_binding(bindings, proto->binding_count, name);
		if (!binding)
			return VRML_FAIL(parser, -EBADMSG, parser->scope->lexer.line,
					 "PROTO %s has no field %.40s; correct its name",
					 proto->name, name);
		if (!vrml_take(parser, "IS")) {
			rc = parse_value(parser, binding->type, &binding->value);
			continue;
		}
		rc = vrml_take_name(parser, &outside, "a name after IS");
		if (rc < 0)
			break;
		outer = find_binding(parser->scope->bindings, parser->scope->binding_count,
				     outside);
		if (outer && outer->type == binding->type && outer->value)
			binding->value = outer->value;
	}
	return rc;
}

/* Parses the body of a prototype once more; its first node is the instance. */
static int parse_body(struct vrml_parser *parser, const struct vrml_proto *proto,
		      const struct vrml_binding *bindings, struct vrml_node **out)
{
	struct vrml_scope *outer = parser->scope;
	struct vrml_scope scope = {
		.source = proto->source,
		.lexer = proto->body,
		.protos = proto->before,
		.bindings = bindings,
		.binding_count = proto->binding_count,
	};
	struct vrml_list nodes = { 0 };
	int rc;

	parser->scope = &scope;
	rc = parse_nodes(parser, &nodes, true);
	parser->reread_bytes += (uint64_t)(scope.lexer.at - proto->body.at);
	if (rc == 0 && parser->reread_bytes > REREAD_BYTES_MAX)
		rc = VRML_FAIL(parser, -EFBIG, proto->body.line,
			       "PROTO %s is used too often; use DEF and USE instead", proto->name);
	if (rc == 0 && nodes.count == 0)
		rc = VRML_FAIL(parser, -EBADMSG, proto->body.line,
			       "PROTO %s has no node; give it one", proto->name);
	if (rc == 0)
		*out = *(struct vrml_node **)nodes.items;
	free(nodes.items);
	map_finish(&scope.definitions);
	parser->scope = outer;
	return rc;
}

static int parse_instance(struct vrml_parser *parser, const struct vrml_proto *proto, unsigned line,
			  struct vrml_node **out)
{
	struct vrml_binding *bindings;
	int rc = proto->urls ? resolve(parser, &proto, line) : 0;

	if (rc == 0)
		rc = vrml_expect(parser, "{");
	if (rc < 0)
		return rc;
	bindings = arena_alloc(&parser->scene->arena, proto->binding_count * sizeof(*bindings) + 1);
	if (!bindings)
		return vrml_fail_memory(parser);
	memcpy(bindings, proto->bindings, proto->binding_count * sizeof(*bindings));
	rc = parse_instance_fields(parser, proto, bindings);
	return rc < 0 ? rc : parse_body(parser, proto, bindings, out);
}

/* ---- nodes */

/* One side of a ROUTE: node.event */
static int parse_event(struct vrml_parser *parser, struct vrml_node *const **node,
		       const char **event, unsigned line)
{
	const struct vrml_definition *definition;
	const char *name = NULL;
	int rc = vrml_take_name(parser, &name, "the name of a node");

	if (rc == 0)
		rc = vrml_expect(parser, ".");
	if (rc == 0)
		rc = vrml_take_name(parser, event, "the name of an event");
	if (rc < 0)
		return rc;
	definition = vrml_find_definition(parser->scope, name);
	if (!definition)
		return VRML_FAIL(parser, -EBADMSG, line,
				 "ROUTE names %.40s, but no node before it is called so by DEF",
				 name);
	/* It may be the node that is being parsed, which is set when it ends. */
	*node = &definition->node;
	return 0;
}

/* ROUTE a.event TO b.event */
static int parse_route(struct vrml_parser *parser)
{
	struct vrml_route *route = arena_alloc(&parser->scene->arena, sizeof(*route));
	unsigned line = parser->scope->lexer.line;
	int rc;

	if (!route)
		return vrml_fail_memory(parser);
	*route = (struct vrml_route){ .before = parser->scene->routes,
				      .file = parser->scope->source->path,
				      .line = line };
	rc = parse_event(parser, &route->from, &route->out, line);
	if (rc == 0)
		rc = vrml_expect(parser, "TO");
	if (rc == 0)
		rc = parse_event(parser, &route->to, &route->in, line);
	if (rc == 0) {
		parser->scene->routes = route;
		parser->scene->route_count++;
	}
	return rc;
}

/* Parses a statement that is not a node. Returns 1 if there was one, 0 if not. */
static int parse_statement(struct vrml_parser *parser)
{
	int rc;

	if (vrml_take(parser, "ROUTE"))
		rc = parse_route(parser);
	else if (vrml_take(parser, "PROTO"))
		rc = parse_proto(parser, false);
	else if (vrml_take(parser, "EXTERNPROTO"))
		rc = parse_proto(parser, true);
	else
		return 0;
	return rc < 0 ? rc : 1;
}

static int parse_field(struct vrml_parser *parser, struct vrml_node *node)
{
	const struct vrml_binding *binding;
	struct vrml_token token = vrml_take_any(parser);
	const char *outside = NULL;
	int field, rc;

	if (token.kind != VRML_WORD)
		return vrml_fail_token(parser, &token, "a field or }");
	field = vrml_field_named(node->type, token.text, token.length);
	if (vrml_take(parser, "IS")) {
		rc = vrml_take_name(parser, &outside, "a name after IS");
		if (rc < 0)
			return rc;
		binding = find_binding(parser->scope->bindings, parser->scope->binding_count,
				       outside);
		if (!binding)
			return VRML_FAIL(parser, -EBADMSG, token.line,
					 "IS names %.40s, which the prototype does not declare",
					 outside);
		if (field >= 0 && binding->value && binding->type == node->type->fields[field].type)
			node->values[field] = binding->value;
		return 0;
	}
	if (field >= 0)
		return parse_value(parser, node->type->fields[field].type, &node->values[field]);
	diagnostics_add(parser->warnings, 0, parser->scope->source->path, token.line,
			"%s has no field %.*s in VRML97; it was left out", node->type->name,
			vrml_shown(&token), token.text);
	return skip_value(parser);
}

static int load_inline(struct vrml_parser *parser, struct vrml_node *node)
{
	int field = vrml_field_named(node->type, "url", 3);
	const struct vrml_value *urls = node->values[field];
	struct vrml_source *source;
	int rc;

	if (!urls || urls->count == 0)
		return 0;
	rc = load(parser, &source, urls, node->line);
	if (rc == 0) {
		node->children = source->roots;
		node->child_count = source->root_count;
	}
	return rc;
}

static int parse_fields(struct vrml_parser *parser, struct vrml_node *node)
{
	int rc = vrml_expect(parser, "{");

	while (rc >= 0 && !vrml_take(parser, "}")) {
		rc = parse_statement(parser);
		if (rc == 0)
			rc = parse_field(parser, node);
	}
	return rc < 0 ? rc : 0;
}

static int parse_typed(struct vrml_parser *parser, const struct vrml_token *name,
		       struct vrml_node **out)
{
	const struct vrml_proto *proto;
	struct vrml_node *node;
	char text[64];
	int rc;

	if (vrml_token_is(name, "Script"))
		return VRML_FAIL(
			parser, -ENOTSUP, name->line,
			"Script is a program in the scene and is not run; remove it, or use "
			"sensors, timers and interpolators instead");
	snprintf(text, sizeof(text), "%.*s", (int)(name->length < 63 ? name->length : 63),
		 name->text);
	proto = find_proto(parser->scope->protos, text);
	if (proto)
		return parse_instance(parser, proto, name->line, out);
	node = arena_alloc(&parser->scene->arena, sizeof(*node));
	if (!node)
		return vrml_fail_memory(parser);
	node->type = vrml_node_type_named(name->text, name->length);
	node->line = name->line;
	node->file = parser->scope->source->path;
	if (!node->type)
		return VRML_FAIL(
			parser, -EBADMSG, name->line,
			"%.*s is no node of VRML97 and no PROTO declared before; remove it, or "
			"export the scene as VRML97",
			vrml_shown(name), name->text);
	rc = parse_fields(parser, node);
	if (rc == 0 && strcmp(node->type->name, "Inline") == 0)
		rc = load_inline(parser, node);
	*out = node;
	return rc;
}

static int parse_use(struct vrml_parser *parser, struct vrml_node **out)
{
	const struct vrml_definition *definition;
	const char *name = NULL;
	unsigned line = parser->scope->lexer.line;
	int rc = vrml_take_name(parser, &name, "a name after USE");

	if (rc < 0)
		return rc;
	definition = vrml_find_definition(parser->scope, name);
	if (!definition)
		return VRML_FAIL(parser, -EBADMSG, line,
				 "USE names %.40s, but no node before it is called so by DEF",
				 name);
	*out = definition->node;
	return *out ? 0
		    : VRML_FAIL(parser, -EBADMSG, line, "%.40s contains itself by USE; remove this",
				name);
}

/* Parses a node. *out stays NULL for the word NULL. */
static int parse_node(struct vrml_parser *parser, struct vrml_node **out)
{
	const char *name = NULL;
	struct vrml_token token;
	struct vrml_definition *definition = NULL;
	int rc = 0;

	*out = NULL;
	if (vrml_take(parser, "NULL"))
		return 0;
	if (vrml_take(parser, "USE"))
		return parse_use(parser, out);
	if (vrml_take(parser, "DEF")) {
		rc = vrml_take_name(parser, &name, "a name after DEF");
		if (rc == 0)
			rc = vrml_define(parser, name, &definition);
	}
	if (rc < 0)
		return rc;
	token = vrml_take_any(parser);
	if (token.kind != VRML_WORD)
		return vrml_fail_token(parser, &token, "a node");
	if (++parser->depth > DEPTH_MAX)
		return VRML_FAIL(parser, -EFBIG, token.line,
				 "nodes are nested over %d deep; flatten the scene", DEPTH_MAX);
	if (++parser->node_count > NODES_MAX)
		return VRML_FAIL(parser, -EFBIG, token.line,
				 "over %d nodes; split the scene into several files", NODES_MAX);
	rc = parse_typed(parser, &token, out);
	parser->depth--;
	if (rc == 0 && definition) {
		definition->node = *out;
		(*out)->name = name;
	}
	return rc;
}

/* Parses nodes and statements up to the end of the file, or of the braces. */
static int parse_nodes(struct vrml_parser *parser, struct vrml_list *nodes, bool in_braces)
{
	int rc = 0;

	while (rc >= 0) {
		struct vrml_node *node = NULL;
		struct vrml_token token = vrml_peek(parser);

		if (in_braces ? vrml_token_is(&token, "}") : token.kind == VRML_END)
			break;
		rc = parse_statement(parser);
		if (rc != 0)
			continue;
		rc = parse_node(parser, &node);
		if (rc == 0 && node)
			rc = vrml_push(parser, nodes, &node, sizeof(node));
	}
	return rc < 0 ? rc : 0;
}

static int check_head(struct vrml_parser *parser, const char *text)
{
	if (strncmp(text, "#VRML V1", 8) == 0)
		return VRML_FAIL(parser, -EBADMSG, 1,
				 "it is VRML 1.0; export it as VRML97 (VRML 2.0) instead");
	if (strncmp(text, "#VRML V2.0 utf8", 15) != 0)
		return VRML_FAIL(parser, -EBADMSG, 1,
				 "it does not begin with '#VRML V2.0 utf8'; export it as VRML97");
	return 0;
}

/* Parses a whole file. */
int vrml_parse_source(struct vrml_parser *parser, struct vrml_source *source)
{
	struct vrml_scope *outer = parser->scope;
	struct vrml_scope scope = { .source = source,
				    .lexer = { (const char *)source->text.data, 1 } };
	struct vrml_list nodes = { 0 };
	int rc;

	parser->scope = &scope;
	source->is_open = true;
	rc = check_head(parser, scope.lexer.at);
	if (rc == 0)
		rc = parse_nodes(parser, &nodes, false);
	source->root_count = nodes.count;
	if (rc == 0) {
		source->roots = vrml_settle(parser, &nodes, sizeof(struct vrml_node *));
		rc = source->roots ? 0 : vrml_fail_memory(parser);
	}
	free(nodes.items);
	source->protos = scope.protos;
	source->is_open = false;
	source->is_parsed = rc == 0;
	map_finish(&scope.definitions);
	parser->scope = outer;
	return rc;
}
