/* The SQL of db/schema and db/queries, compiled in. Internal to this floor. */
#ifndef SUNDER_STORE_SQL_H
#define SUNDER_STORE_SQL_H

typedef struct sql_file {
    const char *name; /* the file's, without .sql */
    const char *text;
} sql_file;

extern const sql_file sql_schema[]; /* [sql_schema_count]: migration i brings the schema from version i to i + 1 */
extern const int sql_schema_count;
extern const sql_file sql_queries[]; /* [sql_queries_count], by name */
extern const int sql_queries_count;

#endif
