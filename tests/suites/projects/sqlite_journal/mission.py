import sqlite3


def palletize(arm, path):
    database = sqlite3.connect(path)
    database.execute("create table if not exists moves (name text, x real)")
    for name in ("pick", "place"):
        arm.move(0.2 if name == "pick" else 0.4)
        database.execute("insert into moves values (?, ?)", (name, arm.position()))
        database.commit()
    database.close()
