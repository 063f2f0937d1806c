import checked

checked.install()
