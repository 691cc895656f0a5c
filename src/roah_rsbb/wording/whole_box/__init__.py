"""What faces say of the whole box: the robots that it hears, the home devices, its end."""
