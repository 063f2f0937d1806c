"""Operations that have a name on a middleware, as vocabularies write them."""
