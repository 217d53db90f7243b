"""Right: a fast timer looks at the count and cancels once; the program is quiet but for one line in French."""
import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


class ClientDiscret(Node):
    def __init__(self):
        super().__init__('client_discret')
        self.client = ActionClient(self, Fibonacci, 'fibonacci')
        self.recus = 0
        self.but = None
        self.veilleur = self.create_timer(0.005, self.veiller)

    def compter(self, _message):
        self.recus += 1

    def veiller(self):
        if self.but is not None and self.recus >= 3:
            self.veilleur.cancel()
            self.but.cancel_goal_async()

    def envoyer(self):
        futur = self.client.send_goal_async(Fibonacci.Goal(order=20), feedback_callback=self.compter)
        rclpy.spin_until_future_complete(self, futur)
        if not futur.result().accepted:
            return 'rejected'
        self.but = futur.result()
        resultat = self.but.get_result_async()
        rclpy.spin_until_future_complete(self, resultat)
        return resultat.result().status


def main():
    rclpy.init()
    noeud = ClientDiscret()
    if noeud.client.wait_for_server(timeout_sec=10.0):
        print('Status final :', noeud.envoyer())


if __name__ == '__main__':
    main()
