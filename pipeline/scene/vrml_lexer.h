/* Splits the text of a VRML97 file (ISO/IEC 14772-1, clause 5 and annex A) into tokens. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_LEXER_H
#define GOPURA_PIPELINE_SCENE_VRML_LEXER_H

#include <stdbool.h>
#include <stddef.h>

enum vrml_token_kind {
	VRML_END,    /* of the text */
	VRML_WORD,   /* a name or a keyword */
	VRML_NUMBER, /* a whole or decimal number, or hexadecimal */
	VRML_STRING, /* its text without the quotes; what is escaped in it still is */
	VRML_MARK,   /* one of [ ] { } . */
	VRML_BAD,    /* a character that begins no token, or a string without its end */
};

struct vrml_token {
	enum vrml_token_kind kind;
	const char *text; /* borrowed from the lexer's text; not terminated */
	size_t length;
	unsigned line;
};

/* A place in a text; may be copied to come back to it. */
struct vrml_lexer {
	const char *at; /* borrowed; the text ends with a zero byte */
	unsigned line;  /* from 1 */
};

/* Reads the next token and moves past it; commas and comments count as blanks. At the end of the
 * text, and at a bad token, it stays where it is. */
struct vrml_token vrml_next(struct vrml_lexer *lexer);
/* Returns whether a token is this word or mark. */
bool vrml_token_is(const struct vrml_token *token, const char *text);

#endif
